// engine/analysis/ghost_job.h — rays of ghost_beam.h on a device, an item a ray.
#pragma once
#include <cstdint>
#include <span>

#include "engine/analysis/ghost_rays.h"
#include "engine/optics/device/lens_view.h"

namespace lensproof::analysis {

/// What every such job is told.
struct GhostRays {
    static constexpr int kThreadsPerBlock = 64;  // of a few thousand rays: more processors of the GPU have some

    optics::LensView<double> lens;
    FrontBeam beam;
    optics::StrayMirrors<double> mirrors;
    double image_radius = 0.0;
    std::span<const int> path;
    const Vec2d* offsets = nullptr;

    struct Scene {
        optics::LensView<double>::AtWavelength lens;
        const FrontBeam& beam;
        const optics::StrayMirrors<double>& mirrors;
        double image_radius;
    };
    [[nodiscard]] constexpr Scene scene() const { return {lens.at(0), beam, mirrors, image_radius}; }
};

struct LandingJob : GhostRays {
    Landing* landings = nullptr;
    std::uint8_t* lands = nullptr;

    constexpr void operator()(int item) const {
        const std::optional<Landing> found = traced_landing(scene(), path, offsets[item]);
        lands[item] = found ? 1 : 0;
        if (found) {
            landings[item] = *found;
        }
    }
};

/// Of ray i from i · `most` on.
struct MarginJob : GhostRays {
    double* margins = nullptr;
    std::int32_t* counts = nullptr;
    std::uint8_t* arrives = nullptr;
    int most = 0;

    constexpr void operator()(int item) const {
        double* to = margins + static_cast<std::ptrdiff_t>(item) * most;
        int count = 0;
        arrives[item] =
            trace_margins(scene(), path, offsets[item], [&](double margin) { to[count++] = margin; }) ? 1 : 0;
        counts[item] = count;
    }
};

struct RimRayJob : GhostRays {
    RimRay* rays = nullptr;

    constexpr void operator()(int item) const { rays[item] = traced_rim_ray(scene(), path, offsets[item]); }
};

}  // namespace lensproof::analysis
