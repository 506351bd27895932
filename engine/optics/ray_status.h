// engine/optics/ray_status.h — what became of a ray.
#pragma once
#include <cstdint>

namespace lensproof::optics {

/// Why a ray ended, or `ok`.
enum class RayStatus : std::uint8_t {
    ok,
    missed,                     // does not meet the surface's sphere, or only its far side
    clipped,                    // meets a refracting surface beyond its rim
    total_internal_reflection,  // beyond the critical angle
    stopped,                    // meets the aperture stop outside its opening
};

/// The status as files spell it: "ok", "missed", "clipped", "total-internal-reflection", "stopped".
constexpr const char* status_name(RayStatus status) {
    switch (status) {
        case RayStatus::ok:
            return "ok";
        case RayStatus::missed:
            return "missed";
        case RayStatus::clipped:
            return "clipped";
        case RayStatus::total_internal_reflection:
            return "total-internal-reflection";
        case RayStatus::stopped:
            return "stopped";
    }
    return "unknown";
}

}  // namespace lensproof::optics
