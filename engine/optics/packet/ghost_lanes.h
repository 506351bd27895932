// engine/optics/packet/ghost_lanes.h — rays along one ghost side by side: one at several wavelengths, or several at
// one.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "engine/base/simd_level.h"
#include "engine/optics/ghost_limits.h"
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

inline constexpr std::size_t kFollowedRays = 8;

/// Rays along a ghost past rims: as they enter the lens, and what becomes of each.
struct FollowedRays {
    std::array<TracedRay<double>, kFollowedRays> ray;
    std::array<WorstLimit, kFollowedRays> worst;  // of all limits that it has met
};

/// `trace_ghost` with Rims::follow at the lens's first wavelength. Given is the `ray` of each; status, which is ok or
/// missed, and, where it is ok, ray and transmittance come back, with the bits that each has by itself at any `level`
/// as above.
void follow_ghost_rays(const SpectralLens<double>& lens, const GhostPath& path, const StrayMirrors<double>& mirrors,
                       FollowedRays& rays, std::optional<SimdLevel> level = std::nullopt);

}  // namespace lensproof::optics
