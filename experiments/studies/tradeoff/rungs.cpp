#include "experiments/studies/tradeoff/rungs.h"

#include <fmt/format.h>
#include <malloc.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "engine/base/input_error.h"
#include "engine/base/order_statistics.h"
#include "engine/formats/image/image_json.h"
#include "engine/render/film/film_image.h"
#include "engine/render/prepared_scene.h"
#include "experiments/studies/tradeoff/processor_time.h"

namespace lensproof::studies {

void fields(JsonArchive& json, RungCost& cost) {
    json.field("ns_per_path", cost.ns_per_path)
        .field("ns_per_sample", cost.ns_per_sample)
        .field("samples", cost.samples)
        .field("seconds", cost.seconds)
        .field("memory_mib", cost.memory_mib);
}

void fields(JsonArchive& json, MeasuredRung& rung) {
    json.field("name", rung.name)
        .field("not_applicable", rung.not_applicable)
        .field("samples", rung.samples)
        .field("picture_rgb", rung.picture_rgb)
        .field("field", rung.field)
        .field("picture", rung.picture)
        .field("cost", rung.cost);
}

namespace {

using formats::Image;

double heap_mib() {
    const struct mallinfo2 heap = mallinfo2();
    return static_cast<double>(heap.uordblks + heap.hblkhd) / (1024.0 * 1024.0);
}

/// A quarter of a second's paths from all over the film, the median of five.
double ns_per_path(const render::Camera& camera, std::uint64_t seed) {
    constexpr int kRuns = 5;
    constexpr double kSeconds = 0.05;
    constexpr std::uint32_t kSamples = 16;
    const render::Sensor& sensor = camera.sensor();
    const auto pixels = static_cast<std::uint32_t>(sensor.width) * static_cast<std::uint32_t>(sensor.height);
    const std::uint32_t stride = std::max(1U, pixels / 61U);  // no divisor of usual widths
    render::CameraPaths paths = camera.paths(seed, render::PathCarry::wavelengths);
    render::CameraPathBuffer buffer;
    std::vector<double> found;
    std::uint32_t pixel = 0;
    for (int run = 0; run < kRuns; ++run) {
        const double start = processor_seconds(CLOCK_THREAD_CPUTIME_ID);
        double seconds = 0.0;
        double drawn = 0.0;
        while (seconds < kSeconds) {
            const std::uint32_t some = std::min(256U, pixels - pixel);
            paths.start({.first_pixel = pixel, .pixels = some, .first_sample = 0, .samples = kSamples});
            while (paths.fill(buffer)) {
            }
            drawn += some * kSamples;
            pixel = (pixel + stride) % pixels;
            seconds = processor_seconds(CLOCK_THREAD_CPUTIME_ID) - start;
        }
        found.push_back(1e9 * seconds / drawn);
    }
    return median(found);
}

/// Pictures of a scene, a seed each, and what they cost.
struct SeedPictures {
    std::vector<Image> rgb;
    double seconds = 0.0;  // of one core, for all of them
    double noise = 0.0;    // of a picture: root mean square of a pixel's standard error over its luminance
    double memory_mib = 0.0;
};

SeedPictures render_seeds(const render::SceneSetup& setup, const TradeoffSettings& settings) {
    SeedPictures pictures;
    const double before = heap_mib();
    const render::PreparedScene scene(setup, render::PixelFilter{}, settings.cache);
    pictures.memory_mib = heap_mib() - before;
    for (int seed = 0; seed < settings.seeds; ++seed) {
        const render::Render render = scene.render(settings.probe.seed + static_cast<std::uint64_t>(seed), false);
        const double start = processor_seconds();
        const render::Film film = render::render_film(
            render, {.first = 0, .end = static_cast<std::uint32_t>(settings.samples)}, settings.probe.threads);
        pictures.seconds += processor_seconds() - start;
        pictures.rgb.push_back(render::film_rgb(film));
    }
    pictures.noise = relative_noise(pictures.rgb);
    return pictures;
}

Image mean_of(const std::vector<Image>& pictures) {
    Image mean = pictures.front();
    std::ranges::fill(mean.pixels, 0.0F);
    for (const Image& picture : pictures) {
        std::ranges::transform(mean.pixels, picture.pixels, mean.pixels.begin(), [&](float sum, float value) {
            return sum + value / static_cast<float>(pictures.size());
        });
    }
    return mean;
}

/// The seeds of a model are none of the reference's, so that no noise is taken for what both have in common.
TradeoffSettings for_model(TradeoffSettings settings) {
    settings.probe.seed += static_cast<std::uint64_t>(settings.seeds);
    return settings;
}

/// What every rung is held against.
struct Reference {
    render::Camera camera;
    std::vector<ProbePoint> points;
    std::vector<Image> pictures;
};

MeasuredRung measure_rung(const Rung& rung, const render::SceneSetup& own, const Reference& reference,
                          const TradeoffSettings& settings) {
    MeasuredRung measured{.name = rung.name};
    if (rung.hits && !own.scene.has_triangles()) {
        measured.not_applicable = "the scene has no triangles, and all else is met in double";
        return measured;
    }
    const render::SceneSetup setup = on_rung(own, rung);
    const render::PixelFilter box;
    try {
        const render::Camera camera(setup.camera, setup.spectral, box, settings.cache, true);
        measured.field = field_errors(reference.camera, camera, reference.points, settings.probe);
        measured.cost.ns_per_path = ns_per_path(camera, settings.probe.seed);
    } catch (const InputError& error) {
        measured.not_applicable = error.what();
        return measured;
    }
    const render::SceneSetup small = with_pixels(setup, settings.pixels);
    const SeedPictures pictures = render_seeds(small, for_model(settings));
    measured.picture = picture_errors(pictures.rgb, reference.pictures, settings.probe.threads);
    measured.picture_rgb = mean_of(pictures.rgb);
    measured.samples = settings.samples * settings.seeds;
    const render::Sensor& sensor = small.camera.sensor;
    const double samples = static_cast<double>(sensor.width) * sensor.height * settings.samples * settings.seeds;
    measured.cost.ns_per_sample = 1e9 * pictures.seconds / samples;
    measured.cost.samples = settings.samples * std::pow(pictures.noise / settings.noise, 2);
    measured.cost.seconds =
        1e-9 * measured.cost.ns_per_sample * measured.cost.samples * own.camera.sensor.width * own.camera.sensor.height;
    measured.cost.memory_mib = pictures.memory_mib;
    return measured;
}

/// Whether an error is no larger than another, as far as both are known.
bool errs_no_more(const Measured& a, const Measured& b) {
    return a.value <= b.value + 2.0 * std::hypot(a.standard_error, b.standard_error);
}

bool beats(const MeasuredRung& a, const MeasuredRung& b) {
    constexpr double kCheaper = 0.95;
    return a.not_applicable.empty() && a.cost.seconds < kCheaper * b.cost.seconds &&
           errs_no_more(a.field.frame.image_px, b.field.frame.image_px) &&
           errs_no_more(a.field.frame.exposure_ev, b.field.frame.exposure_ev) &&
           errs_no_more(a.picture.ciede2000.bias, b.picture.ciede2000.bias);
}

}  // namespace

const std::vector<Rung>& ladder() {
    using render::LensModel;
    static const std::vector<Rung> rungs = [] {
        std::vector<Rung> all;
        for (const LensModel model :
             {LensModel::pinhole, LensModel::pinhole_profile, LensModel::thin_lens, LensModel::thin_lens_profile,
              LensModel::paraxial, LensModel::polynomial, LensModel::exact_float, LensModel::exact}) {
            all.push_back({.name = render::name_of(model), .model = model});
        }
        all.push_back({.name = kReferenceRung});
        all.push_back({.name = fmt::format("{}-float-hits", kReferenceRung), .hits = scene::HitPrecision::in_float});
        for (const int wavelengths : {16, 8, 4}) {
            all.push_back(
                {.name = fmt::format("{}-{}-wavelengths", kReferenceRung, wavelengths), .wavelengths = wavelengths});
        }
        return all;
    }();
    return rungs;
}

render::SceneSetup on_rung(render::SceneSetup setup, const Rung& rung) {
    if (!render::traces_surfaces(rung.model)) {
        setup.stray_camera = setup.camera;
        setup.camera.blades.reset();
        setup.camera.barrel.reset();
        setup.camera.dust.reset();
    }
    setup.camera.model = rung.model;
    setup.scene.precision = rung.hits.value_or(setup.scene.precision);
    if (rung.wavelengths) {
        setup.spectral.layers = *rung.wavelengths;
        setup.spectral.strata_per_layer = 1;
    }
    return setup;
}

render::SceneSetup with_pixels(render::SceneSetup setup, int pixels) {
    render::Sensor& sensor = setup.camera.sensor;
    const double all = static_cast<double>(sensor.width) * sensor.height;
    const double factor = std::sqrt(std::min(1.0, pixels / all));
    const int width = std::max(1, static_cast<int>(std::lround(factor * sensor.width)));
    const double coarser = static_cast<double>(sensor.width) / width;
    sensor.height = std::max(1, static_cast<int>(std::lround(sensor.height / coarser)));
    sensor.width = width;
    sensor.pixel_pitch_mm *= coarser;
    sensor.axis_from_middle_px = (1.0 / coarser) * sensor.axis_from_middle_px;
    return setup;
}

void compare_rungs(std::vector<MeasuredRung>& rungs) {
    const auto reference = std::ranges::find(rungs, kReferenceRung, &MeasuredRung::name);
    for (MeasuredRung& rung : rungs) {
        if (!rung.not_applicable.empty()) {
            continue;
        }
        rung.is_pareto = std::ranges::none_of(rungs, [&](const MeasuredRung& other) { return beats(other, rung); });
    }
    if (reference == rungs.end()) {
        return;
    }
    // Noise falls with the root of the samples; that of a difference is both pictures'.
    for (MeasuredRung& rung : rungs) {
        const double samples = rung.cost.samples * reference->cost.seconds / rung.cost.seconds;
        const auto at_equal_time = [&](const SeenDifference& seen) {
            return std::hypot(seen.bias.value, seen.noise * std::sqrt(0.5 * rung.samples / samples));
        };
        rung.ciede2000_at_equal_time = at_equal_time(rung.picture.ciede2000);
        rung.flip_at_equal_time = at_equal_time(rung.picture.flip);
    }
}

std::vector<MeasuredRung> measure_tradeoff(const render::SceneSetup& setup, const std::vector<Rung>& rungs,
                                           const TradeoffSettings& settings,
                                           const std::function<void(const std::string&, double)>& progress) {
    if (setup.camera.focal_length_mm) {
        throw InputError(
            "the scene's camera has a focal length in the place of a lens; expected a lens, which models "
            "are held against");
    }
    const double steps = static_cast<double>(rungs.size()) + 1.0;
    progress(kReferenceRung, 0.0);
    const Rung exact{.name = kReferenceRung};
    render::SceneSetup judged = setup;
    judged.scene.precision = scene::HitPrecision::in_double;  // of all rungs but the one that says otherwise
    const render::SceneSetup setup_of_lens = on_rung(judged, exact);
    Reference reference{
        .camera = {setup_of_lens.camera, setup_of_lens.spectral, render::PixelFilter{}, settings.cache, true},
        .points = {},
        .pictures = render_seeds(with_pixels(setup_of_lens, settings.pixels), settings).rgb};
    reference.points = probe_points(reference.camera, settings.points);
    std::vector<MeasuredRung> measured;
    for (const Rung& rung : rungs) {
        progress(rung.name, (static_cast<double>(measured.size()) + 1.0) / steps);
        measured.push_back(measure_rung(rung, judged, reference, settings));
    }
    compare_rungs(measured);
    return measured;
}

}  // namespace lensproof::studies
