// tests/validation/studio.h — a camera before a small scene, and films that each kind of path makes of it.
#pragma once
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include "engine/render/integrators/energy_audit.h"
#include "engine/render/integrators/passes.h"
#include "engine/render/integrators/stray_paths.h"
#include "engine/render/stray/ghost_entrance.h"
#include "tests/validation/rendered_scene.h"
#include "tests/validation/small_scene.h"

namespace lensproof {

/// A lens, or one of the ideal cameras that stand for it, before a scene; and a film of few, large pixels.
class Studio {
  public:
    struct Setup {
        std::string lens;
        double f_number = 2.0;
        double focus_mm = 2000.0;
        render::LensModel model = render::LensModel::exact;
        render::Sensor sensor;
        spectral::SpectralGrid grid;
        int max_bounces = 3;
        render::PixelFilter filter;
        optics::StrayMirrors<double> mirrors;
        optics::BarrelFinish barrel;
        std::optional<render::DustSettings> dust;
    };

    Studio(const Setup& setup, const SceneParts& parts)
        : world_(parts.scene()),
          camera_({.lens = setup.lens,
                   .mirrors = setup.mirrors,
                   .barrel = setup.barrel,
                   .dust = setup.dust,
                   .f_number = setup.f_number,
                   .focus_distance_mm = setup.focus_mm,
                   .sensor = setup.sensor,
                   .response = "luminance",
                   .model = setup.model},
                  {setup.grid.strata.min_nm, setup.grid.strata.max_nm, setup.grid.size(), 1}, setup.filter, {}, true),
          view_{.world = &world_, .camera = &camera_, .seed = 1, .paths = {.max_bounces = setup.max_bounces}} {}
    Studio(const Studio&) = delete;
    Studio& operator=(const Studio&) = delete;

    [[nodiscard]] render::Film by_camera(std::uint32_t samples) const { return film_by("camera", samples); }
    [[nodiscard]] render::Film by_lights(std::uint32_t samples) const { return film_by("light", samples); }
    [[nodiscard]] render::Film by_both(std::uint32_t samples) const { return film_by("both", samples); }

    [[nodiscard]] render::Film by_pass(const char* pass, std::uint32_t samples) const {
        return film_of(render::pass_named(pass).render(view_, render::integrator_named("camera")), samples);
    }

    /// All of what is left to chance inside the lens by light paths: the other way to what a pass makes from both ends.
    [[nodiscard]] render::Film by_light_paths(render::StrayClass wanted, std::uint32_t samples) const {
        return by_entrance(render::WalkEntrance(camera_, wanted), samples);
    }
    [[nodiscard]] render::Film ghosts_by_light_paths(std::uint32_t samples) const {
        return by_entrance(render::GhostEntrance(camera_), samples);
    }

    [[nodiscard]] render::EnergyAudit audit(std::uint32_t paths) const { return render::energy_audit(view_, paths); }

    [[nodiscard]] const scene::Scene& scene() const { return view_.scene(); }
    [[nodiscard]] const render::Camera& camera() const { return camera_; }

  private:
    template <class Entrance>
    [[nodiscard]] render::Film by_entrance(const Entrance& entrance, std::uint32_t samples) const {
        render::Render render{
            .film = camera_.film(), .renderer = render::LightPaths(view_, entrance, 1), .lands_anywhere = true};
        render.film.has_splats = true;
        return film_of(std::move(render), samples);
    }
    [[nodiscard]] render::Film film_by(const char* integrator, std::uint32_t samples) const {
        return film_of(render::integrator_named(integrator).render(view_), samples);
    }

    static render::Film film_of(render::Render render, std::uint32_t samples) {
        // R, G and B all are the mean irradiance over the band.
        const double per_nm = 1.0 / render.film.band_nm;
        render.film.rgb_weights.assign(render.film.rgb_weights.size(), {per_nm, per_nm, per_nm});
        const render::PixelRect all{.width = render.film.width, .height = render.film.height};
        return rendered(render, {&all, 1}, samples);
    }

    render::World world_;
    render::Camera camera_;
    render::View view_;
};

/// How far two films are apart, for what their variances allow.
struct FilmDifference {
    double chi2 = 0.0;  // over the pixels that have a variance
    int lit = 0;
    double first = 0.0;  // sums over the pixels
    double second = 0.0;
    double error = 0.0;  // standard, of their difference
};

inline FilmDifference difference(const render::Picture& first, const render::Picture& second) {
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
inline void expect_same_image(const render::Picture& first, const render::Picture& second, double most_error = 0.015) {
    const FilmDifference found = difference(first, second);
    EXPECT_NEAR(found.first, found.second, 4.0 * found.error);
    EXPECT_LT(found.error, most_error * found.first);
    EXPECT_GT(found.lit, first.width() * first.height() / 2);
    EXPECT_LT(found.chi2, found.lit + 5.0 * std::sqrt(2.0 * found.lit));
}

}  // namespace lensproof
