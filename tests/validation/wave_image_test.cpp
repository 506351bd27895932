// Suns imaged by waves: against closed forms, the boundary integral of the wave, and the light that rays bring.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "engine/analysis/edge_wave.h"
#include "engine/base/angle.h"
#include "engine/render/integrators/passes.h"
#include "engine/render/stray/wave_entrance.h"
#include "tests/validation/rendered_scene.h"
#include "tests/validation/small_scene.h"

namespace lensproof::wave_image_test {

constexpr double kWavelengthNm = 546.25;  // the first of the grid's
const spectral::SpectralGrid kGrid = spectral::spectral_grid(545.0, 555.0, 4);

struct Setting {
    double f_number = 8.0;
    int blades = 0;                // 0: a circle
    Vec3d towards{0.0, 0.0, 1.0};  // as the camera looks
};

render::CameraSettings tessar(const Setting& setting) {
    render::CameraSettings camera{.lens = "tessar",
                                  .f_number = setting.f_number,
                                  .focus_distance_mm = kInfinity,
                                  .sensor = {.width = 16, .height = 16, .pixel_pitch_mm = 1e-3},
                                  .response = "luminance"};
    if (setting.blades > 0) {
        camera.blades = optics::PolygonStop{.blades = setting.blades, .curvature = 0.0, .rotation_deg = 10.0};
    }
    return camera;
}

scene::SunLight sun(const Vec3d& towards, double across_deg) {
    return {.towards = towards,
            .cos_radius = std::cos(radians(0.5 * across_deg)),
            .radiance = spectral::constant_spectrum(1.0, kGrid)};
}

/// What WaveEntrance draws of a star's first wavelength: by distance from where the chief ray lands.
class DrawnLight {
  public:
    DrawnLight(const render::Camera& camera, const Vec3d& towards, Vec2d image_mm, int draws) {
        const render::WaveEntrance entrance(camera, {sun(towards, 1e-4)}, {});
        for (int i = 0; i < draws; ++i) {
            render::PathSampler numbers(1, 0, static_cast<std::uint32_t>(i));
            const auto entry = entrance.draw({-1.0 * towards, true}, kGrid.path(0), false, numbers);
            if (entry && entry->weight[0] > 0.0) {
                const Vec2d at = camera.sensor().position(entry->at_px[0].x, entry->at_px[0].y);
                landed_.push_back({length(at - image_mm), entry->weight[0] / entry->pdf / draws});
            }
        }
    }

    /// In mm² of the incoming beam.
    [[nodiscard]] double between(double near_mm, double far_mm) const {
        double sum = 0.0;
        for (const auto& [distance, light] : landed_) {
            sum += distance >= near_mm && distance < far_mm ? light : 0.0;
        }
        return sum;
    }

  private:
    struct Landed {
        double distance_mm;
        double light_mm2;
    };
    std::vector<Landed> landed_;
};

/// A lens's wave beyond its rays, and λN there.
struct Star {
    analysis::EdgeWave wave;
    double airy_mm;

    explicit Star(const render::Camera& camera, const Setting& setting)
        : wave(optics::StopAim(camera.exact().lens().at()[0], camera.lens()->stop_index()), camera.lens()->stop_mask,
               {camera.in_lens_space({-1.0 * setting.towards, true}).at, true}, kWavelengthNm, 192),
          airy_mm(1e-6 * kWavelengthNm * setting.f_number) {}

    /// By points that are even over radii and azimuths, each jittered by the golden ratio.
    [[nodiscard]] double between(double near_mm, double far_mm) const {
        constexpr int kPoints = 40'000;
        constexpr double kGolden = 0.6180339887498949;
        double sum = 0.0;
        for (int i = 0; i < kPoints; ++i) {
            const double radius = near_mm + (far_mm - near_mm) * (i + 0.5) / kPoints;
            const double azimuth = 2.0 * kPi * kGolden * i;
            sum += 2.0 * kPi * radius * wave.irradiance(radius * Vec2d{std::cos(azimuth), std::sin(azimuth)});
        }
        return (far_mm - near_mm) * sum / kPoints;
    }
};

/// Of all the light of a perfect circular pupil, what lands farther out, λN (Born & Wolf, Principles of Optics, 7th
/// ed., § 8.5.2, eq. 18).
double beyond_of_circle(double airy) {
    const double x = kPi * airy;
    return std::pow(std::cyl_bessel_j(0.0, x), 2) + std::pow(std::cyl_bessel_j(1.0, x), 2);
}

// At f/22 this lens has a wavefront of 0.012 waves rms, whose Strehl ratio of 0.9945 takes as much from the core as the
// cells of λN / 2 do: half a percent each. In rings of some width light counts to 1 % by 400,000 draws, and the FFT's
// repetition adds (1/7)² = 2 %. From 64 λN on edges' rays have the mean of the rings.
TEST(WaveImage, OfACircleIsAirys) {
    const Setting setting{.f_number = 22.0};
    const render::Camera camera(tessar(setting), {545.0, 555.0, 4, 1}, {}, {});
    const Star star(camera, setting);
    const DrawnLight drawn(camera, setting.towards, star.wave.image_point(), 400'000);
    const double all = drawn.between(0.0, kInfinity);
    const auto fraction = [&](double near, double far) {
        return drawn.between(near * star.airy_mm, far * star.airy_mm) / all;
    };
    EXPECT_NEAR(fraction(0.0, 1.22), 1.0 - beyond_of_circle(1.22), 0.012);
    for (const auto& [near, far] : {std::array{3.238, 5.0}, {5.0, 10.0}, {10.0, 20.0}, {20.0, 60.0}, {70.0, 140.0}}) {
        const double airys = beyond_of_circle(near) - beyond_of_circle(far);
        EXPECT_NEAR(fraction(near, far) / airys, 1.0, 0.03) << near << " to " << far << " λN";
    }
}

// Far from the rays, where the wave is its boundary's alone: there too each has all of its light to 3 %, of polygons
// and beside the axis, and edges' rays go on where the image ends.
TEST(WaveImage, HasTheWavesProfile) {
    const double tilt = radians(10.0);
    for (const Setting& setting : {Setting{.f_number = 8.0, .blades = 6},
                                   Setting{.f_number = 11.0,
                                   .blades = 5,
                                   .towards = {0.6 * std::sin(tilt), 0.8 * std::sin(tilt), std::cos(tilt)}}}) {
        const render::Camera camera(tessar(setting), {545.0, 555.0, 4, 1}, {}, {});
        const Star star(camera, setting);
        const DrawnLight drawn(camera, setting.towards, star.wave.image_point(), 400'000);
        for (const auto& [near, far] : {std::array{10.0, 20.0}, {20.0, 40.0}, {40.0, 60.0}, {70.0, 140.0}}) {
            const double by_wave = star.between(near * star.airy_mm, far * star.airy_mm);
            EXPECT_NEAR(drawn.between(near * star.airy_mm, far * star.airy_mm) / by_wave, 1.0, 0.03)
                << setting.blades << " blades, " << near << " to " << far << " λN";
        }
    }
}

struct Seen {
    double light = 0.0;
    Vec2d middle_px;
};

Seen seen(const render::Film& film) {
    Seen all;
    for (int y = 0; y < film.layout().height; ++y) {
        for (int x = 0; x < film.layout().width; ++x) {
            const double here = film.estimate(x, y).rgb.y;
            all.light += here;
            all.middle_px = all.middle_px + here * Vec2d{static_cast<double>(x), static_cast<double>(y)};
        }
    }
    all.middle_px = (1.0 / all.light) * all.middle_px;
    return all;
}

// A sun's disc, 5° off the axis, on a film that holds all of its light but 0.1 % (what edges send farther): as much of
// it, and in the same place, as straight rays bring. These land a coma beside their chief ray, of 2 µm.
TEST(WaveImage, BringsTheLightOfRays) {
    constexpr double kPitchMm = 0.125;
    render::CameraSettings settings = tessar({.f_number = 8.0, .blades = 6});
    settings.sensor = {.width = 256, .height = 256, .pixel_pitch_mm = kPitchMm};
    const render::Camera camera(settings, {545.0, 555.0, 4, 1}, {}, {}, true);
    SceneParts parts(kGrid);
    parts.add(scene::Sphere{1.0}, {.linear = kIdentity3, .translation = {0.0, 0.0, -500.0}}, 0.5);
    parts.lights.emplace_back(sun({std::sin(radians(5.0)), 0.0, std::cos(radians(5.0))}, 0.53));
    const render::World world = parts.scene();
    const render::View view{.world = &world, .camera = &camera, .seed = 1, .paths = {}};
    const auto film_of = [&](const char* pass) {
        return render::render_film(render::pass_named(pass).render(view, render::integrator_named("light")),
                                   {.first = 0, .end = 2}, 0);
    };
    const Seen by_rays = seen(film_of("direct"));
    const Seen by_waves = seen(film_of("waves"));
    EXPECT_NEAR(by_waves.light / by_rays.light, 1.0, 0.003);
    EXPECT_NEAR(kPitchMm * length(by_waves.middle_px - by_rays.middle_px), 0.0, 0.004);

    // Its light is nowhere twice.
    const std::vector<render::Render> renders = render::renders_of({"direct", "diffracted", "waves"}, view, {});
    for (const std::size_t without : {0, 1}) {
        const render::Film film = render::render_film(renders[without], {.first = 0, .end = 1}, 0);
        EXPECT_EQ(seen(film).light, 0.0);
    }
}

}  // namespace lensproof::wave_image_test
