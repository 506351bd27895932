// experiments/python/module.cpp — the native part of the Python package: the command line as a function, and what gives
// or takes arrays. The package beside it (lensproof/) makes a face for people of it.
#include <cstdint>
#include <cstdio>
#include <memory>
#include <mutex>
#include <optional>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "engine/analysis/lens_analysis.h"
#include "engine/analysis/wave_curves.h"
#include "engine/base/data_root.h"
#include "engine/base/parallel.h"
#include "engine/optics/packet/trace_arrays.h"
#include "experiments/cli/lens_options.h"
#include "experiments/cli/program.h"
#include "experiments/python/array.h"
#include "experiments/python/bridge.h"
#include "experiments/python/exr_parts.h"
#include "experiments/python/interruptible.h"

namespace lensproof::python {

namespace {

bridge::bytes bytes_of(const std::vector<double>& numbers) {
    return bridge::bytes(reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(double));
}

/// Exit status, the bytes of `--json -`, and why it failed. One command at a time.
bridge::tuple run_command(const std::vector<std::string>& arguments) {
    static std::mutex one_at_a_time;
    const auto [outcome, json] = interruptible([&] {
        const std::scoped_lock lock(one_at_a_time);
        std::ostringstream result;
        cli::Outcome ended = cli::run_program(arguments, result);
        std::fflush(stdout);
        return std::pair(std::move(ended), std::move(result).str());
    });
    return bridge::make_tuple(outcome.status, bridge::bytes(json.data(), json.size()), outcome.message);
}

bridge::bytes bytes_of(const std::vector<Vec2d>& points, double Vec2d::*member) {
    std::vector<double> numbers;
    numbers.reserve(points.size());
    for (const Vec2d& point : points) {
        numbers.push_back(point.*member);
    }
    return bytes_of(numbers);
}

/// look(field, degrees) of each field whose light arrives, dark(degrees) of the others.
template <class Look, class Dark>
auto of_fields(const cli::AnalysedLens& loaded, const Look& look, const Dark& dark) {
    const std::vector<double>& fields_deg = loaded.settings.fields_deg;
    const auto fields = analysis::polychromatic_fields(loaded.lens, loaded.settings);
    std::vector<decltype(dark(0.0))> result(fields.size());
    parallel_for(static_cast<int>(fields.size()), 0, [&](int field) {
        const auto i = static_cast<std::size_t>(field);
        result[i] = fields[i] ? look(*fields[i], fields_deg[i]) : dark(fields_deg[i]);
    });
    return result;
}

/// A lens as `analyze` would look at it.
class LoadedLens {
  public:
    explicit LoadedLens(const std::vector<std::string>& arguments)
        : loaded_(interruptible([&] { return cli::read_analysed_lens(arguments); })) {}

    [[nodiscard]] std::string name() const { return loaded_.lens.name; }
    [[nodiscard]] double image_z_mm() const { return loaded_.lens.image_z; }
    [[nodiscard]] double reference_wavelength_nm() const { return loaded_.settings.reference_wavelength_nm; }
    [[nodiscard]] std::vector<double> wavelengths_nm() const { return loaded_.settings.wavelengths_nm; }
    [[nodiscard]] std::vector<double> fields_deg() const { return loaded_.settings.fields_deg; }

    /// `given`: x_mm, y_mm, z_mm, dx, dy, dz. `traced`: those, optical path, transmittance, each aligned to 64 bytes
    /// and as long as a multiple of 16; then status and surface. `which`: of the wavelengths each ray's, or none.
    void trace(const std::vector<bridge::object>& given, const std::vector<bridge::object>& traced,
               const std::vector<double>& wavelengths_nm, const std::optional<bridge::object>& which, bool reverse,
               bool clip, int threads) const {
        const Array<double> x(given.at(0));
        const Array<double> y(given.at(1));
        const Array<double> z(given.at(2));
        const Array<double> dx(given.at(3));
        const Array<double> dy(given.at(4));
        const Array<double> dz(given.at(5));
        const Columns columns(traced, x.size());
        std::optional<Array<std::uint16_t>> wavelength;
        if (which) {
            wavelength.emplace(*which);
        }
        for (const Array<double>* const column : {&y, &z, &dx, &dy, &dz}) {
            if (column->size() != x.size()) {
                throw std::invalid_argument("columns of different lengths");
            }
        }
        const auto from = [](const Array<double>& column) {
            return optics::NumberColumn{column.bytes(), column.stride()};
        };
        const optics::RayArrays rays{from(x), from(y), from(z), from(dx), from(dy), from(dz), x.size()};
        const optics::RayColumns<double> to = columns.rays(wavelength ? wavelength->row(x.size()) : nullptr);
        const optics::BatchSettings settings{.carry = optics::Carry::all,
                                             .rims = clip ? optics::Rims::clip : optics::Rims::follow,
                                             .level = std::nullopt};
        interruptible([&] {
            const optics::SpectralLens<double> at = optics::at_wavelengths<double>(loaded_.lens, wavelengths_nm);
            reverse ? optics::trace_arrays<optics::Direction::reverse>(at, rays, to, settings, threads)
                    : optics::trace_arrays<optics::Direction::forward>(at, rays, to, settings, threads);
            return true;
        });
    }

    /// Of each field: degrees, pixels a side, half the width in µm, intensities in units of a perfect lens's peak, the
    /// Strehl ratio, and why there is none.
    [[nodiscard]] bridge::list psfs() const {
        const auto maps = interruptible([&] {
            return of_fields(
                loaded_, [](const auto& field, double deg) { return analysis::psf_map(field, deg); },
                [](double deg) { return analysis::PsfMap{.field_deg = deg}; });
        });
        bridge::list result;
        for (const analysis::PsfMap& map : maps) {
            result.append(bridge::make_tuple(map.field_deg, map.intensity.size, map.intensity.half_width,
                                             bytes_of(map.intensity.values), map.strehl, map.remark));
        }
        return result;
    }

    /// Of each field: degrees, and at the frequencies (none: those that `analyze --plots` shows) cycles/mm, tangential,
    /// sagittal and the diffraction limit's; and what there is to say.
    [[nodiscard]] bridge::list mtfs(const std::vector<double>& wanted) const {
        struct Curves {
            analysis::FieldMtf real;
            analysis::FieldMtf limit;
        };
        const auto curves = interruptible([&] {
            return of_fields(
                loaded_,
                [&](const auto& field, double deg) {
                    const std::vector<double> frequencies =
                        wanted.empty() ? analysis::shown_frequencies(field) : wanted;
                    return Curves{analysis::resolved_mtf(field, frequencies, deg),
                                  analysis::diffraction_limited_mtf(field, frequencies, deg)};
                },
                [](double deg) {
                    return Curves{{.field_deg = deg}, {.field_deg = deg}};
                });
        });
        bridge::list result;
        for (const auto& [real, limit] : curves) {
            result.append(bridge::make_tuple(real.field_deg, bytes_of(real.tangential, &Vec2d::x),
                                             bytes_of(real.tangential, &Vec2d::y), bytes_of(real.sagittal, &Vec2d::y),
                                             bytes_of(limit.tangential, &Vec2d::y), bytes_of(limit.sagittal, &Vec2d::y),
                                             real.remark));
        }
        return result;
    }

  private:
    /// Where traced rays go, held for as long as this lives.
    class Columns {
      public:
        Columns(const std::vector<bridge::object>& to, std::size_t rays)
            : padded_((rays + optics::kMostLanes - 1) / optics::kMostLanes * optics::kMostLanes),
              rays_(rays),
              status_(to.at(kNumbers), PyBUF_WRITABLE),
              surface_(to.at(kNumbers + 1), PyBUF_WRITABLE) {
            for (std::size_t i = 0; i < kNumbers; ++i) {
                numbers_.push_back(std::make_unique<Array<double>>(to.at(i), PyBUF_WRITABLE));
            }
        }

        [[nodiscard]] optics::RayColumns<double> rays(const std::uint16_t* wavelength) const {
            const auto row = [this](std::size_t i) { return numbers_[i]->row(padded_, optics::kPacketAlignment); };
            return {.x = row(0),
                    .y = row(1),
                    .z = row(2),
                    .dx = row(3),
                    .dy = row(4),
                    .dz = row(5),
                    .optical_path = row(6),
                    .transmittance = row(7),
                    .wavelength = wavelength,
                    .status = reinterpret_cast<optics::RayStatus*>(status_.row(rays_)),
                    .surface = surface_.row(rays_),
                    .size = 0};
        }

      private:
        static constexpr std::size_t kNumbers = 8;
        std::size_t padded_;
        std::size_t rays_;
        std::vector<std::unique_ptr<Array<double>>> numbers_;
        Array<std::uint8_t> status_;
        Array<std::int16_t> surface_;
    };

    cli::AnalysedLens loaded_;
};

/// Of each part: name, channels, width, height, whether its numbers are whole, attributes.
bridge::list list_exr_parts(const std::string& file) {
    bridge::list list;
    for (const ExrPart& part : interruptible([&] { return exr_parts(file); })) {
        bridge::dict attributes;
        for (const auto& [name, text] : part.attributes) {
            attributes[name.c_str()] = text;
        }
        list.append(bridge::make_tuple(part.name, part.channels, part.width, part.height, part.is_whole, attributes));
    }
    return list;
}

void fill_exr_part(const std::string& file, int part, const bridge::object& numbers) {
    const Array<std::uint32_t> to(numbers, PyBUF_WRITABLE);
    std::uint32_t* const row = to.row(to.size());
    interruptible([&] {
        read_exr_part(file, part, row, to.size());
        return true;
    });
}

}  // namespace

LENSPROOF_MODULE(_lensproof, module) {
    module.doc() = "The native part of the package lensproof.";
    module.def("command", &run_command, bridge::arg("arguments"));
    module.def("data_root", [] { return data_root().string(); });
    module.def("exr_parts", &list_exr_parts, bridge::arg("file"));
    module.def("read_exr_part", &fill_exr_part, bridge::arg("file"), bridge::arg("part"), bridge::arg("numbers"));
    bridge::class_<LoadedLens>(module, "LoadedLens")
        .def(bridge::init<const std::vector<std::string>&>(), bridge::arg("arguments"))
        .def("name", &LoadedLens::name)
        .def("image_z_mm", &LoadedLens::image_z_mm)
        .def("reference_wavelength_nm", &LoadedLens::reference_wavelength_nm)
        .def("wavelengths_nm", &LoadedLens::wavelengths_nm)
        .def("fields_deg", &LoadedLens::fields_deg)
        .def("trace", &LoadedLens::trace, bridge::arg("given"), bridge::arg("traced"), bridge::arg("wavelengths_nm"),
             bridge::arg("which").none(), bridge::arg("reverse"), bridge::arg("clip"), bridge::arg("threads"))
        .def("psfs", &LoadedLens::psfs)
        .def("mtfs", &LoadedLens::mtfs, bridge::arg("frequencies_per_mm"));
}

}  // namespace lensproof::python
