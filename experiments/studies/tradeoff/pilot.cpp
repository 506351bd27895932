#include "experiments/studies/tradeoff/pilot.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

#include "engine/base/input_error.h"
#include "engine/render/film/film_image.h"
#include "experiments/studies/tradeoff/picture_error.h"
#include "experiments/studies/tradeoff/processor_time.h"
#include "experiments/studies/tradeoff/rungs.h"

namespace lensproof::studies {

using formats::Image;

Pilot::Pilot(const render::SceneSetup& setup, const PilotSettings& settings)
    : setup_(on_rung(setup, {.name = kReferenceRung})),
      small_(with_pixels(setup_, settings.pixels)),
      settings_(settings),
      camera_(std::make_unique<render::Camera>(setup_.camera, setup_.spectral, render::PixelFilter{}, settings.cache,
                                               true)),
      points_(probe_points(*camera_, settings.points)),
      scene_(std::make_unique<render::PreparedScene>(small_, render::PixelFilter{}, settings.cache)) {
    for (int seed = 0; seed < settings_.seeds; ++seed) {
        const std::uint64_t own = settings_.probe.seed + static_cast<std::uint64_t>(seed);
        full_.rgb.push_back(picture(scene_->render(own, false), settings_.samples, full_.ns_per_sample));
    }
    find_depth();
}

Image Pilot::picture(const render::Render& render, int samples, double& ns_per_sample) const {
    const double start = processor_seconds();
    const render::Film film =
        render::render_film(render, {.first = 0, .end = static_cast<std::uint32_t>(samples)}, settings_.probe.threads);
    const double taken = static_cast<double>(width()) * height() * samples * settings_.seeds;
    ns_per_sample += 1e9 * (processor_seconds() - start) / taken;
    return render::film_rgb(film);
}

Pilot::Pictures Pilot::render(const render::SceneSetup& setup, const std::vector<std::string>& stray_passes,
                              int first_seed) const {
    render::PreparedScene scene(with_pixels(setup, settings_.pixels), render::PixelFilter{}, settings_.cache);
    std::vector<std::string> passes = {"straight"};
    passes.insert(passes.end(), stray_passes.begin(), stray_passes.end());
    Pictures pictures;
    for (int seed = 0; seed < settings_.seeds; ++seed) {
        const std::uint64_t own = settings_.probe.seed + static_cast<std::uint64_t>(first_seed + seed);
        if (stray_passes.empty()) {
            pictures.rgb.push_back(picture(scene.render(own, false), settings_.samples, pictures.ns_per_sample));
            continue;
        }
        const std::vector<render::Render> renders = scene.render(passes, own, false, false);
        for (std::size_t i = 0; i < renders.size(); ++i) {
            double ns = 0.0;
            Image more = picture(renders[i], i == 0 ? settings_.samples : settings_.stray_samples, ns);
            pictures.ns_per_sample += ns;
            if (i == 0) {
                pictures.rgb.push_back(std::move(more));
            } else {
                pictures.stray_ns[passes[i]] += ns;
                Image& sum = pictures.rgb.back();
                std::ranges::transform(sum.pixels, more.pixels, sum.pixels.begin(), std::plus<>());
            }
        }
    }
    return pictures;
}

Pilot::Pictures Pilot::with_pass(const std::string& pass) const {
    Pictures with = full_;
    with.ns_per_sample = 0.0;
    for (int seed = 0; seed < settings_.seeds; ++seed) {
        const std::uint64_t own = settings_.probe.seed + static_cast<std::uint64_t>(seed);
        const std::vector<render::Render> renders = scene_->render({"imaged", pass}, own, false, false);
        const Image stray = picture(renders.back(), settings_.stray_samples, with.ns_per_sample);
        const auto straight = static_cast<float>(renders.front().film.kept_fraction);
        Image& sum = with.rgb[static_cast<std::size_t>(seed)];
        std::ranges::transform(sum.pixels, stray.pixels, sum.pixels.begin(),
                               [&](float light, float more) { return straight * light + more; });
    }
    return with;
}

std::string Pilot::why_no_pass(const std::string& pass) const {
    try {
        static_cast<void>(scene_->render(std::vector<std::string>{pass}, settings_.probe.seed, false));
        return {};
    } catch (const InputError& error) {
        return error.what();
    }
}

void Pilot::find_depth() {
    depth_.assign(static_cast<std::size_t>(width()) * static_cast<std::size_t>(height()),
                  std::numeric_limits<double>::quiet_NaN());
    if (setup_.chart) {
        std::ranges::fill(depth_, setup_.chart->placement.distance_mm);
        return;
    }
    render::SceneSetup sharp = small_;
    sharp.max_bounces = 0;
    const render::PreparedScene scene(sharp, render::PixelFilter{}, settings_.cache);
    const render::Film film =
        render::render_film(scene.render(settings_.probe.seed, true), {.first = 0, .end = 4}, settings_.probe.threads);
    for (int y = 0; y < height(); ++y) {
        for (int x = 0; x < width(); ++x) {
            if (film.coverage(x, y) > 0.0) {
                depth_[index(x, y)] = film.features(x, y).depth_mm;
            }
        }
    }
}

double Pilot::image_height(int x, int y) const {
    const render::Sensor& sensor = small_.camera.sensor;
    return std::hypot(x - sensor.axis().x, y - sensor.axis().y) * sensor.pixel_pitch_mm / sensor.half_diagonal_mm();
}

Vec2d Pilot::outwards(int x, int y) const {
    const Vec2d from = Vec2d{static_cast<double>(x), static_cast<double>(y)} - small_.camera.sensor.axis();
    const double distance = std::hypot(from.x, from.y);
    return distance > 0.0 ? (1.0 / distance) * from : Vec2d{};
}

double Pilot::noise_of_sample() const {
    return relative_noise(full_.rgb) * std::sqrt(static_cast<double>(settings_.samples));
}

}  // namespace lensproof::studies
