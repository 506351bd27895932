// engine/optics/packet/ghost_lanes.h — the wavelengths of one ray along one ghost, side by side.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "engine/base/simd_level.h"
#include "engine/optics/ghost_path.h"
#include "engine/optics/packet/spectral_lens.h"

namespace lensproof::optics {

inline constexpr std::size_t kGhostLanes = 4;

/// Where `trace_ghost` ends, a wavelength each. Of one that does not arrive the rest means nothing.
struct GhostLanes {
    std::array<bool, kGhostLanes> arrives{};
    std::array<Ray<double>, kGhostLanes> ray;
    std::array<double, kGhostLanes> transmittance{};
};

/// `trace_ghost` of a ray that enters the lens at four of its wavelengths, each with the bits that it has by itself at
/// any `level` (nothing: the widest available; throws std::invalid_argument where it is not).
GhostLanes trace_ghost_lanes(const SpectralLens<double>& lens, std::span<const std::uint16_t, kGhostLanes> wavelengths,
                             const GhostPath& path, const Ray<double>& ray, const StrayMirrors<double>& mirrors,
                             std::optional<SimdLevel> level = std::nullopt);

}  // namespace lensproof::optics
