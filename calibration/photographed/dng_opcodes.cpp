#include "calibration/photographed/dng_opcodes.h"

#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <span>

#include "engine/base/input_error.h"

namespace lensproof::calibration {

namespace {

enum OpcodeId : std::uint32_t {
    kWarpRectilinear = 1,
    kWarpFisheye = 2,
    kFixVignetteRadial = 3,
    kTrimBounds = 6,
    kWarpRectilinear2 = 14,
};

/// Numbers from the front of a list, which are big-endian whatever the file is.
class ListReader {
  public:
    ListReader(std::string_view bytes, const std::string& name) : bytes_(bytes), name_(name) {}

    std::uint32_t integer() { return static_cast<std::uint32_t>(number(sizeof(std::uint32_t))); }

    void finite(std::span<double> values) {
        for (double& value : values) {
            value = std::bit_cast<double>(number(sizeof(double)));
            if (!std::isfinite(value)) {
                throw InputError(fmt::format("{}: an opcode has the number {}", name_, value));
            }
        }
    }

    std::string_view take(std::size_t size) {
        if (bytes_.size() < size) {
            throw InputError(fmt::format("{}: the list of opcodes ends {} bytes early", name_, size - bytes_.size()));
        }
        const std::string_view taken = bytes_.substr(0, size);
        bytes_.remove_prefix(size);
        return taken;
    }

    void expect_end(const char* opcode) const {
        if (!bytes_.empty()) {
            throw InputError(fmt::format("{}: {} has {} bytes too many", name_, opcode, bytes_.size()));
        }
    }

  private:
    std::uint64_t number(std::size_t size) {
        std::uint64_t value = 0;
        for (const char byte : take(size)) {
            value = value << 8 | static_cast<unsigned char>(byte);
        }
        return value;
    }

    std::string_view bytes_;
    const std::string& name_;
};

void read_centre(ListReader& values, const std::string& name, std::array<double, 2>& centre) {
    values.finite(centre);
    for (const double fraction : centre) {
        if (!(fraction >= 0.0 && fraction <= 1.0)) {
            throw InputError(fmt::format("{}: an opcode's centre is at {}, expected 0 to 1", name, fraction));
        }
    }
}

RectilinearWarp read_warp(ListReader values, const std::string& name) {
    RectilinearWarp warp;
    const std::uint32_t planes = values.integer();
    if (planes != 1 && planes != 3) {
        throw InputError(fmt::format("{}: WarpRectilinear has {} planes, expected 1 or 3", name, planes));
    }
    warp.planes.resize(planes);
    for (RectilinearWarp::Plane& plane : warp.planes) {
        values.finite(plane.radial);
        values.finite(plane.tangential);
        if (!(plane.radial[0] > 0.0)) {
            throw InputError(
                fmt::format("{}: WarpRectilinear magnifies by {}, expected more than 0", name, plane.radial[0]));
        }
    }
    read_centre(values, name, warp.centre);
    values.expect_end("WarpRectilinear");
    return warp;
}

RadialGain read_gain(ListReader values, const std::string& name) {
    RadialGain gain;
    values.finite(gain.k);
    read_centre(values, name, gain.centre);
    values.expect_end("FixVignetteRadial");
    return gain;
}

void expect_first(bool is_there, const char* opcode, const std::string& name) {
    if (is_there) {
        throw InputError(fmt::format("{}: {} comes twice, expected once", name, opcode));
    }
}

[[noreturn]] void refuse(const char* opcode, const std::string& name) {
    throw InputError(fmt::format("{}: its lens is corrected by {}, expected WarpRectilinear", name, opcode));
}

}  // namespace

void read_opcodes(std::string_view list, const std::string& name, LensOpcodes& found) {
    ListReader reader(list, name);
    bool is_trimmed = false;
    for (std::uint32_t left = reader.integer(); left > 0; --left) {
        const std::uint32_t id = reader.integer();
        reader.take(2 * sizeof(std::uint32_t));  // version, flags
        const ListReader values(reader.take(reader.integer()), name);
        switch (id) {
            case kWarpRectilinear:
                expect_first(found.warp.has_value(), "WarpRectilinear", name);
                if (is_trimmed) {
                    refuse("WarpRectilinear after TrimBounds", name);
                }
                found.warp = read_warp(values, name);
                break;
            case kFixVignetteRadial:
                expect_first(found.gain.has_value(), "FixVignetteRadial", name);
                found.gain = read_gain(values, name);
                break;
            case kTrimBounds:
                is_trimmed = true;
                break;
            case kWarpFisheye:
                refuse("WarpFisheye", name);
            case kWarpRectilinear2:
                refuse("WarpRectilinear2", name);
            default:
                break;
        }
    }
}

}  // namespace lensproof::calibration
