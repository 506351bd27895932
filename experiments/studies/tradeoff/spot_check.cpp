#include "experiments/studies/tradeoff/spot_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <mutex>
#include <vector>

#include "engine/base/input_error.h"
#include "engine/base/parallel.h"
#include "engine/render/prepared_scene.h"
#include "experiments/studies/tradeoff/picture_error.h"

namespace lensproof::studies {

namespace {

using formats::Image;

/// Windows on a grid of the frame's shape, each in the middle of its cell; of a small frame all of it.
std::vector<render::PixelRect> windows_of(const render::Sensor& sensor, const SpotCheckSettings& settings) {
    const int side = std::min({settings.across, sensor.width, sensor.height});
    const double cell = std::sqrt(static_cast<double>(sensor.width) * sensor.height / settings.windows);
    const auto parts = [&](int length) { return std::clamp(static_cast<int>(length / cell), 1, length / side); };
    const int columns = parts(sensor.width);
    const int rows = parts(sensor.height);
    std::vector<render::PixelRect> windows;
    for (int row = 0; row < rows; ++row) {
        for (int column = 0; column < columns; ++column) {
            windows.push_back({.x = (2 * column + 1) * sensor.width / (2 * columns) - side / 2,
                               .y = (2 * row + 1) * sensor.height / (2 * rows) - side / 2,
                               .width = side,
                               .height = side});
        }
    }
    return windows;
}

/// The windows side by side, linear RGB.
Image render_windows(const render::Render& render, const std::vector<render::PixelRect>& windows,
                     const SpotCheckSettings& settings) {
    render::FilmLayout layout = render.film;
    layout.layer_nm = {layout.layer_nm.front()};  // its colours alone
    render::Film film(layout);
    std::mutex at_film;
    const auto make_worker = [&] {
        return [&, renderer = render.renderer, tile = render::FilmTile(layout)](int i) mutable {
            const render::TileSamples samples{.rect = windows[static_cast<std::size_t>(i)],
                                              .first = 0,
                                              .end = static_cast<std::uint32_t>(settings.samples)};
            {
                const std::scoped_lock lock(at_film);
                film.load(samples, tile);
            }
            renderer(samples, tile);
            tile.finish();
            const std::scoped_lock lock(at_film);
            film.store(tile);
        };
    };
    parallel_for_workers(static_cast<int>(windows.size()), settings.threads, make_worker, [](int) {});
    const int side = windows.front().width;
    Image image = formats::make_image(side * static_cast<int>(windows.size()), side, {"R", "G", "B"});
    for (std::size_t i = 0; i < windows.size(); ++i) {
        for (int y = 0; y < side; ++y) {
            for (int x = 0; x < side; ++x) {
                const Vec3d rgb = film.estimate(windows[i].x + x, windows[i].y + y).rgb;
                float* pixel =
                    &image.pixels[3 * static_cast<std::size_t>(y * image.width + static_cast<int>(i) * side + x)];
                pixel[0] = static_cast<float>(rgb.x);
                pixel[1] = static_cast<float>(rgb.y);
                pixel[2] = static_cast<float>(rgb.z);
            }
        }
    }
    return image;
}

}  // namespace

SpotCheckSettings SpotCheckSettings::for_render(const render::SceneSetup& setup) {
    constexpr double kPart = 0.02;
    constexpr double kPictures = 4.0;  // two seeds, as planned and with the full model
    SpotCheckSettings settings;
    const render::Sensor& sensor = setup.camera.sensor;
    const double all = static_cast<double>(sensor.width) * sensor.height * setup.samples_per_pixel;
    const double least = kPictures * settings.windows * settings.across * settings.across * settings.samples;
    const double more = std::sqrt(std::max(1.0, kPart * all / least));
    settings.windows = static_cast<int>(more * settings.windows);
    settings.samples = static_cast<int>(more * settings.samples);
    return settings;
}

std::vector<Image> window_pictures(const render::SceneSetup& setup, std::uint64_t first_seed,
                                   const SpotCheckSettings& settings) {
    const std::vector<render::PixelRect> windows = windows_of(setup.camera.sensor, settings);
    const render::PreparedScene scene(setup, render::PixelFilter{}, settings.cache);
    std::vector<Image> pictures;
    for (std::uint64_t seed = first_seed; seed < first_seed + 2; ++seed) {
        pictures.push_back(render_windows(scene.render(seed, false), windows, settings));
    }
    return pictures;
}

Plan spot_checked(Plan plan, const render::SceneSetup& setup, const SpotCheckSettings& settings) {
    const auto start = std::chrono::steady_clock::now();
    const render::SceneSetup full = on_rung(setup, {.name = kReferenceRung});
    const auto is_full = [&] { return plan.render.rung.name == kReferenceRung && !plan.render.is_reduced(full); };
    if (is_full()) {
        return plan;
    }
    const std::vector<Image> judge = window_pictures(full, settings.seed, settings);
    const std::vector<PlannedRender> others = dearer_renders(plan.render, full);
    plan.spots.pixels = judge.front().width * judge.front().height;
    for (std::size_t i = 0; !is_full(); ++i) {
        try {
            const std::vector<Image> planned =
                window_pictures(planned_setup(setup, plan.render), settings.seed + 2, settings);
            const PictureErrors found = picture_errors(planned, judge, settings.threads);
            plan.spots.error = {.px = {},
                                .ev = {std::abs(found.exposure_ev.value), found.exposure_ev.standard_error},
                                .ciede2000 = found.ciede2000.bias};
            if (keeps(surely(plan.spots.error), plan.tolerance)) {
                break;
            }
            plan.refused.push_back(fmt::format("{}: {}, at {} of the scene's own pixels", plan.render.rung.name,
                                               excess(surely(plan.spots.error), plan.tolerance), plan.spots.pixels));
        } catch (const InputError& error) {  // this lens has no such model
            plan.refused.push_back(fmt::format("{}: {}", plan.render.rung.name, error.what()));
        }
        plan.spots.is_revised = true;
        plan.spots.error = {};
        plan.render = others.at(i);
    }
    plan.probe_seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return plan;
}

}  // namespace lensproof::studies
