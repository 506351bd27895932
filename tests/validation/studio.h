// tests/validation/studio.h — a camera before a small scene, and films that each kind of path makes of it.
#pragma once
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/infinity.h"
#include "engine/formats/prescription/load_lens.h"
#include "engine/optics/focus.h"
#include "engine/optics/lens.h"
#include "engine/render/light_tracer.h"
#include "engine/render/scene_render.h"
#include "engine/scene/scene_description.h"
#include "tests/validation/small_scene.h"

namespace lensproof {

/// A lens, or one of the ideal cameras that stand for it, before a scene; and a film of few, large pixels.
class Studio {
  public:
    struct Setup {
        std::string lens;
        double f_number = 2.0;
        double focus_mm = 2000.0;
        scene::LensModel model = scene::LensModel::exact;
        render::Sensor sensor;
        spectral::SpectralGrid grid;
        int max_bounces = 3;
        render::PixelFilter filter;
    };

    Studio(Setup setup, SceneParts& parts)
        : setup_(std::move(setup)),
          lens_(optics::focused_at(optics::with_f_number(formats::load_lens(setup_.lens), setup_.f_number),
                                   setup_.focus_mm)),
          scene_(parts.scene()) {
        end_.camera_to_world = scene::camera_to_world({});
        end_.sensor = setup_.sensor;
        if (setup_.model == scene::LensModel::exact) {
            traced_.emplace(optics::at_wavelengths<double>(lens_, setup_.grid.strata.midpoints()));
            pupil_.emplace(traced_->at(), true, setup_.sensor.half_diagonal_mm(setup_.filter.radius_px() - 0.5));
            slices_ = std::make_unique<pupil::PupilSlices>(*pupil_, setup_.grid.size());
            map_.emplace(traced_->at(), true, kInfinity, pupil::PupilMapSettings{.defensive_fraction = 0.2});
            camera_ = render::ExactCamera{&*traced_, slices_.get()};
            end_.entrance = render::LensEntrance{
                .lens = &*traced_, .pupil = &*pupil_, .map = &*map_, .front = pupil::front_sphere(traced_->at(0))};
        } else {
            std::vector<render::GaussianCamera> cameras;
            for (const double nm : setup_.grid.strata.midpoints()) {
                cameras.push_back(render::gaussian_camera(lens_, setup_.model, nm));
            }
            camera_ = std::move(cameras);
            end_.entrance = render::IdealEntrance{&std::get<std::vector<render::GaussianCamera>>(camera_)};
        }
    }
    Studio(const Studio&) = delete;
    Studio& operator=(const Studio&) = delete;

    [[nodiscard]] render::Film by_camera(std::uint32_t samples) const {
        return film_of(render::scene_renderer(view()), samples);
    }
    [[nodiscard]] render::Film by_lights(std::uint32_t samples) const {
        return film_of(render::light_path_renderer(view(), end_), samples);
    }
    [[nodiscard]] render::Film by_both(std::uint32_t samples) const {
        return film_of(render::both_paths_renderer(view(), end_), samples);
    }

    [[nodiscard]] const scene::Scene& scene() const { return scene_; }
    [[nodiscard]] const render::CameraEnd& end() const { return end_; }

  private:
    [[nodiscard]] render::SceneView view() const {
        // R, G and B all are the mean irradiance over the band.
        const spectral::WavelengthStrata& strata = setup_.grid.strata;
        const double band = strata.max_nm - strata.min_nm;
        const auto wavelengths = static_cast<std::size_t>(strata.count);
        return {.scene = &scene_,
                .camera = &camera_,
                .camera_to_world = end_.camera_to_world,
                .sensor = setup_.sensor,
                .film = {.width = setup_.sensor.width,
                         .height = setup_.sensor.height,
                         .layer_nm = strata.midpoints(),
                         .rgb_weights = std::vector<Vec3d>(wavelengths, {1.0 / band, 1.0 / band, 1.0 / band}),
                         .band_nm = band,
                         .filter = setup_.filter,
                         .has_splats = true},
                .albedo_weights = {},
                .paths = {.max_bounces = setup_.max_bounces},
                .seed = 1};
    }

    [[nodiscard]] render::Film film_of(const render::TileRenderer& render, std::uint32_t samples) const {
        render::Film film(view().film);
        render::FilmTile tile(film.layout());
        const render::TileSamples all{
            .rect = {0, 0, setup_.sensor.width, setup_.sensor.height}, .first = 0, .end = samples};
        film.load(all, tile);
        render(all, tile);
        tile.finish();
        film.store(tile);
        return film;
    }

    Setup setup_;
    optics::Lens lens_;
    std::optional<optics::SpectralLens<double>> traced_;
    std::optional<pupil::PupilMap> pupil_;
    std::unique_ptr<pupil::PupilSlices> slices_;
    std::optional<pupil::EntranceMap> map_;
    scene::Scene scene_;
    render::SceneCamera camera_;
    render::CameraEnd end_;
};

/// How far two films are apart, for what their variances allow.
struct FilmDifference {
    double chi2 = 0.0;  // over the pixels that have a variance
    int lit = 0;
    double first = 0.0;  // sums over the pixels
    double second = 0.0;
    double error = 0.0;  // standard, of their difference
};

inline FilmDifference difference(const render::Film& first, const render::Film& second) {
    FilmDifference found;
    double variance = 0.0;
    for (int y = 0; y < first.height(); ++y) {
        for (int x = 0; x < first.width(); ++x) {
            const render::PixelEstimate a = first.estimate(x, y);
            const render::PixelEstimate b = second.estimate(x, y);
            const double both = a.variance.x + b.variance.x;
            found.first += a.rgb.x;
            found.second += b.rgb.x;
            variance += both;
            if (both > 0.0) {
                ++found.lit;
                found.chi2 += (a.rgb.x - b.rgb.x) * (a.rgb.x - b.rgb.x) / both;
            }
        }
    }
    found.error = std::sqrt(variance);
    fmt::print("totals {:.5g} and {:.5g}, standard error {:.2f} %, chi² {:.1f} of {} pixels\n", found.first,
               found.second, 100.0 * found.error / found.first, found.chi2, found.lit);
    return found;
}

/// Both are unbiased estimates of one film irradiance, so in each pixel they differ by no more than their standard
/// errors say: χ² over the pixels lies within five of its standard deviations √(2n), and the totals within four errors.
inline void expect_same_image(const render::Film& first, const render::Film& second, double most_error = 0.015) {
    const FilmDifference found = difference(first, second);
    EXPECT_NEAR(found.first, found.second, 4.0 * found.error);
    EXPECT_LT(found.error, most_error * found.first);
    EXPECT_GT(found.lit, first.width() * first.height() / 2);
    EXPECT_LT(found.chi2, found.lit + 5.0 * std::sqrt(2.0 * found.lit));
}

}  // namespace lensproof
