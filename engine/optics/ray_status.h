// engine/optics/ray_status.h — what became of a ray.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

namespace lensproof::optics {

/// Why a ray ended, or `ok`.
enum class RayStatus : std::uint8_t {
    ok,
    missed,                     // does not meet the surface's sphere, or only its far side
    clipped,                    // meets a refracting surface beyond its rim
    total_internal_reflection,  // beyond the critical angle
    stopped,                    // meets the aperture stop outside its opening
    evanescent,                 // a grating's order that does not propagate
};

/// The status as files spell it.
constexpr const char* status_name(RayStatus status) {
    constexpr std::array kNames = {"ok", "missed", "clipped", "total-internal-reflection", "stopped", "evanescent"};
    return kNames[static_cast<std::size_t>(status)];
}

/// Whether a ray that is followed past rims leaves the lens.
constexpr bool gets_through(RayStatus status) {
    return status != RayStatus::missed && status != RayStatus::total_internal_reflection &&
           status != RayStatus::evanescent;
}

}  // namespace lensproof::optics
