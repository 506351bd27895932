// experiments/studies/tradeoff/spot_check.h — a plan held to the scene's own pixels, and revised where it misses.
#pragma once
#include <cstdint>
#include <vector>

#include "experiments/studies/tradeoff/plan.h"

namespace lensproof::studies {

struct SpotCheckSettings {
    int across = 16;   // of a window, px
    int windows = 24;  // about so many, evenly over the frame
    int samples = 16;  // of a pixel and a seed
    std::uint64_t seed = 0;
    int threads = 0;
    Cache cache{};

    /// With more windows and more samples of each, alike, where the render has so many that the check takes a fiftieth
    /// of them.
    static SpotCheckSettings for_render(const render::SceneSetup& setup);
};

/// Windows of the scene's frame at its own pixels, side by side, linear RGB; two seeds from `first_seed` on.
std::vector<formats::Image> window_pictures(const render::SceneSetup& setup, std::uint64_t first_seed,
                                            const SpotCheckSettings& settings);

/// Renders such windows as planned and with the full model, two seeds each, and
/// takes the plan's next camera until the two differ, as far as is sure, by no more than the tolerance: at last the
/// lens itself with all wavelengths and scatterings. A pilot sees no detail finer than its pixels; this does. Stray
/// light is not in it, nor px, which no picture tells. The plan says what was found (`spots`), and what was refused.
Plan spot_checked(Plan plan, const render::SceneSetup& setup, const SpotCheckSettings& settings);

}  // namespace lensproof::studies
