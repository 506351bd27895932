// experiments/studies/tradeoff/rungs.h — the models of a scene's camera, from the simplest to the lens itself: what
// each gets wrong and what it costs.
#pragma once
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/cache.h"
#include "engine/render/scene_setup.h"
#include "experiments/studies/tradeoff/field_probe.h"
#include "experiments/studies/tradeoff/picture_error.h"

namespace lensproof::studies {

inline constexpr const char* kReferenceRung = "exact-double";

/// A lens model, how many wavelengths a render samples and who says which triangle a ray meets (none: as the scene has
/// it).
struct Rung {
    std::string name;
    render::LensModel model = render::LensModel::exact_double;
    std::optional<int> wavelengths = std::nullopt;
    std::optional<scene::HitPrecision> hits = std::nullopt;
};

/// From the simplest to the reference; that with hits in float, and with fewer wavelengths.
const std::vector<Rung>& ladder();

/// The scene with the rung's camera. What only the exact lens has, blades and walls, its stray camera keeps.
render::SceneSetup on_rung(render::SceneSetup setup, const Rung& rung);

/// `setup` at about so many pixels, of the same frame; no more than it has.
render::SceneSetup with_pixels(render::SceneSetup setup, int pixels);

struct TradeoffSettings {
    int pixels = 20'000;  // of the pictures that are compared
    int samples = 32;     // of a pixel and a seed
    int seeds = 4;        // of each rung's pictures
    double noise = 0.02;  // of a pixel's standard error over its value, to which costs are told
    int points = 48;      // over the frame
    ProbeSettings probe;  // its seed is that of the pictures, too
    Cache cache{};
};

struct RungCost {
    double ns_per_path = 0.0;    // of one core, to draw a path out of the camera with all of its wavelengths
    double ns_per_sample = 0.0;  // the path through the scene included
    double samples = 0.0;        // of a pixel, until the wanted noise
    double seconds = 0.0;        // of one core, for all pixels of the scene's own frame until then
    double memory_mib = 0.0;     // of camera and scene, without the film
};
void fields(JsonArchive& json, RungCost& cost);

struct MeasuredRung {
    std::string name;
    std::string not_applicable;  // why this lens has no such model, or the scene no use for it; else empty
    int samples = 0;             // of a pixel, of all seeds together
    formats::Image picture_rgb;  // linear, the mean over seeds
    FieldErrors field;
    PictureErrors picture;
    RungCost cost;
    /// Mean difference of bias and of the rung's own noise after the time that the reference takes to the wanted noise.
    /// Place, width and brightness of images are free of the pictures' noise, and the same at any time.
    double ciede2000_at_equal_time = 0.0;
    double flip_at_equal_time = 0.0;
    bool is_pareto = false;
};
void fields(JsonArchive& json, MeasuredRung& rung);

/// Which rungs no other beats: one that costs less by more than a twentieth and errs no more in image_px, exposure_ev
/// and CIEDE2000, as far as their errors tell. And what each is worth at the reference's time.
void compare_rungs(std::vector<MeasuredRung>& rungs);

/// The ladder of a scene: the reference and `rungs`, in their order. `progress` hears which rung is being measured and
/// how much of all is done. Threads change no number but costs. Throws InputError where the scene's camera has no lens,
/// and as PreparedScene does.
std::vector<MeasuredRung> measure_tradeoff(const render::SceneSetup& setup, const std::vector<Rung>& rungs,
                                           const TradeoffSettings& settings,
                                           const std::function<void(const std::string&, double)>& progress);

}  // namespace lensproof::studies
