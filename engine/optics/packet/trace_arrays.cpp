#include "engine/optics/packet/trace_arrays.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include "engine/base/input_error.h"
#include "engine/base/parallel.h"

namespace lensproof::optics {

namespace {

constexpr std::size_t kChunk = 1024;         // rays whose columns stay in the second-level cache
constexpr std::size_t kPiece = 16 * kChunk;  // for a thread at once
static_assert(kChunk % kMostLanes == 0, "each chunk's columns are aligned as the first's");

// Far beyond any scene, far below what would overflow when squared.
constexpr double kFarthest = 1e15;
// Squared lengths without over- or underflow.
constexpr double kShortest = 1e-200;
constexpr double kLongest = 1e200;

/// Whether all of the numbers are ones that can be traced.
bool put_column(const NumberColumn& from, std::size_t first, std::size_t count, double* to) {
    if (from.stride == static_cast<std::ptrdiff_t>(sizeof(double))) {
        std::memcpy(to, from.first + first * sizeof(double), count * sizeof(double));
    } else {
        for (std::size_t i = 0; i < count; ++i) {
            to[i] = from[first + i];
        }
    }
    bool is_good = true;
    for (std::size_t i = 0; i < count; ++i) {
        is_good &= std::abs(to[i]) <= kFarthest;
    }
    return is_good;
}

[[noreturn]] void complain(const char* column, std::size_t ray, double value, const char* expected) {
    throw InputError(fmt::format("rays: {}[{}] is {}, expected {}", column, ray, value, expected));
}

/// Throws for the first number that cannot be traced.
void find_bad_number(const RayArrays& given, std::size_t first, std::size_t count) {
    for (std::size_t i = first; i < first + count; ++i) {
        for (const auto& [name, column] : {std::pair{"x_mm", &given.x},
                                           {"y_mm", &given.y},
                                           {"z_mm", &given.z},
                                           {"dx", &given.dx},
                                           {"dy", &given.dy},
                                           {"dz", &given.dz}}) {
            if (const double value = (*column)[i]; !(std::abs(value) <= kFarthest)) {
                complain(name, i, value, "a number from -1e15 to 1e15");
            }
        }
    }
}

/// Of any length: by a power of two first, which is exact.
Vec3d unit_vector(const Vec3d& v, std::size_t ray) {
    const double largest = std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
    if (!(largest > 0.0)) {
        complain("dx, dy, dz", ray, 0.0, "a direction");
    }
    const int exponent = std::ilogb(largest);
    return normalized(Vec3d{std::ldexp(v.x, -exponent), std::ldexp(v.y, -exponent), std::ldexp(v.z, -exponent)});
}

/// Makes the chunk's directions, as they were given, unit vectors.
void normalize(const RayColumns<double>& rays, std::size_t first) {
    bool is_plain = true;
    const auto count = static_cast<std::size_t>(rays.size);
    for (std::size_t i = 0; i < count; ++i) {
        const Vec3d v{rays.dx[i], rays.dy[i], rays.dz[i]};
        const double squared = dot(v, v);
        is_plain &= squared > kShortest && squared < kLongest;
    }
    for (std::size_t i = 0; i < count; ++i) {
        const Vec3d v{rays.dx[i], rays.dy[i], rays.dz[i]};
        const Vec3d unit = is_plain ? normalized(v) : unit_vector(v, first + i);
        rays.dx[i] = unit.x;
        rays.dy[i] = unit.y;
        rays.dz[i] = unit.z;
    }
}

/// The columns from `first` on.
RayColumns<double> chunk_of(const RayColumns<double>& all, std::size_t first, std::size_t count) {
    return {.x = all.x + first,
            .y = all.y + first,
            .z = all.z + first,
            .dx = all.dx + first,
            .dy = all.dy + first,
            .dz = all.dz + first,
            .optical_path = all.optical_path + first,
            .transmittance = all.transmittance + first,
            .wavelength = all.wavelength != nullptr ? all.wavelength + first : nullptr,
            .status = all.status + first,
            .surface = all.surface + first,
            .size = static_cast<int>(count)};
}

}  // namespace

template <Direction direction>
void trace_arrays(const SpectralLens<double>& lens, const RayArrays& given, const RayColumns<double>& traced,
                  const BatchSettings& settings, int threads) {
    const auto trace_chunk = [&](std::size_t first) {
        const RayColumns<double> rays = chunk_of(traced, first, std::min(kChunk, given.size - first));
        const auto count = static_cast<std::size_t>(rays.size);
        bool is_good = true;
        for (const auto& [from, to] : {std::pair{&given.x, rays.x},
                                       {&given.y, rays.y},
                                       {&given.z, rays.z},
                                       {&given.dx, rays.dx},
                                       {&given.dy, rays.dy},
                                       {&given.dz, rays.dz}}) {
            is_good &= put_column(*from, first, count, to);
        }
        if (!is_good) {
            find_bad_number(given, first, count);
        }
        normalize(rays, first);
        trace_columns<direction>(lens, rays, settings);
    };
    const std::size_t pieces = (given.size + kPiece - 1) / kPiece;
    parallel_for(static_cast<int>(pieces), threads, [&](int piece) {
        const std::size_t begin = static_cast<std::size_t>(piece) * kPiece;
        for (std::size_t first = begin; first < std::min(begin + kPiece, given.size); first += kChunk) {
            trace_chunk(first);
        }
    });
}

template void trace_arrays<Direction::forward>(const SpectralLens<double>&, const RayArrays&, const RayColumns<double>&,
                                               const BatchSettings&, int);
template void trace_arrays<Direction::reverse>(const SpectralLens<double>&, const RayArrays&, const RayColumns<double>&,
                                               const BatchSettings&, int);

}  // namespace lensproof::optics
