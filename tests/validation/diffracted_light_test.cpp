// Films of diffracted light, through a real lens, against the wave theory.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "engine/analysis/edge_wave.h"
#include "engine/base/angle.h"
#include "engine/base/basis.h"
#include "engine/base/file.h"
#include "engine/base/input_error.h"
#include "engine/base/write_file.h"
#include "engine/formats/image/image.h"
#include "engine/formats/prescription/prescription_file.h"
#include "engine/render/integrators/passes.h"
#include "engine/render/stray/diffracted_entrance.h"
#include "tests/test_folder.h"
#include "tests/validation/rendered_scene.h"
#include "tests/validation/small_scene.h"

namespace lensproof::diffracted_light_test {

const spectral::SpectralGrid kGrid = spectral::spectral_grid(545.0, 555.0, 4);
constexpr double kWavelength_nm = 550.0;
constexpr double kIrradiance = 1000.0;  // of the light, across it
constexpr int kPixelsPerAiry = 3;       // a pixel is λN / 3
constexpr double kRotation_deg = 10.0;

struct Setting {
    int blades = 0;  // 0: a circle
    double f_number = 8.0;
    double curvature = 0.0;
    [[nodiscard]] double airy_mm() const { return 1e-6 * kWavelength_nm * f_number; }
};

render::CameraSettings tessar(const Setting& setting, int pixels) {
    render::CameraSettings camera{
        .lens = "tessar",
        .f_number = setting.f_number,
        .focus_distance_mm = kInfinity,
        .sensor = {.width = pixels, .height = pixels, .pixel_pitch_mm = setting.airy_mm() / kPixelsPerAiry},
        .response = "luminance"};
    if (setting.blades > 0) {
        camera.blades = optics::PolygonStop{
            .blades = setting.blades, .curvature = setting.curvature, .rotation_deg = kRotation_deg};
    }
    return camera;
}

/// What a star on the axis is diffracted to, 100 λN and a little more far, by `paths` light paths.
class StarFilm {
  public:
    StarFilm(const Setting& setting, std::uint32_t paths)
        : camera_(tessar(setting, kPixels), {545.0, 555.0, 4, 1}, {}, {}), film_(camera_.film()) {
        SceneParts parts(kGrid);
        parts.add(scene::Sphere{1.0}, {.linear = kIdentity3, .translation = {0.0, 0.0, -1e4}}, 0.0);
        const double cos_radius = std::cos(1e-5);
        const double cone = 2.0 * kPi * (1.0 - cos_radius);
        parts.lights.emplace_back(
            scene::SunLight{{0.0, 0.0, 1.0}, cos_radius, spectral::constant_spectrum(kIrradiance / cone, kGrid)});
        const render::World world = parts.scene();
        const render::View view{.world = &world, .camera = &camera_, .seed = 1, .paths = {.max_bounces = 0}};
        render::Render render = render::pass_named("diffracted").render(view, render::integrator_named("camera"));
        const double per_nm = 1.0 / render.film.band_nm;
        render.film.rgb_weights.assign(render.film.rgb_weights.size(), {per_nm, per_nm, per_nm});
        const render::PixelRect all{.width = kPixels, .height = static_cast<int>(paths) / kPixels};
        film_ = rendered(render, {&all, 1}, 1);
    }

    /// Visits each pixel: place in λN from the image, irradiance over the light's.
    template <class Visit>
    void for_each(const Visit& visit) const {
        for (int y = 0; y < kPixels; ++y) {
            for (int x = 0; x < kPixels; ++x) {
                const Vec2d place = camera_.sensor().position(x, y);
                visit(place / (kPixelsPerAiry * camera_.sensor().pixel_pitch_mm),
                      film_.estimate(x, y).rgb.x / kIrradiance);
            }
        }
    }

    [[nodiscard]] const render::Camera& camera() const { return camera_; }

  private:
    static constexpr int kPixels = 2 * 101 * kPixelsPerAiry;
    render::Camera camera_;
    render::Film film_;
};

/// Octaves of radius, in λN, half an octave apart. Each is weighed by sin² over it, which averages what oscillates with
/// a period of about a λN.
struct Octave {
    double from = 0.0;
    [[nodiscard]] double weight(double radius) const {
        const double s = std::sin(kPi * (radius / from - 1.0));
        return radius > from && radius < 2.0 * from ? s * s : 0.0;
    }
};
const std::vector<Octave> kOctaves = {{5.0}, {7.0}, {10.0}, {14.0}, {20.0}, {28.0}, {40.0}, {50.0}};

/// Mean irradiances over the light's, an octave each, and the sum from 5 to 100 λN, in (λN)²: its beginning is the mean
/// of those from 5 to 7, since a sharp cut swings with the rings.
struct Profile {
    std::vector<double> irradiance;
    double energy = 0.0;

    /// `visit_all`: calls its argument with (radius, irradiance, area) for the places of the film.
    template <class VisitAll>
    explicit Profile(const VisitAll& visit_all) : irradiance(kOctaves.size()) {
        std::vector<double> weights(kOctaves.size());
        visit_all([&](double radius, double here, double area) {
            energy += radius < 100.0 ? std::clamp(0.5 * (radius - 5.0), 0.0, 1.0) * area * here : 0.0;
            for (std::size_t i = 0; i < kOctaves.size(); ++i) {
                irradiance[i] += kOctaves[i].weight(radius) * area * here;
                weights[i] += kOctaves[i].weight(radius) * area;
            }
        });
        for (std::size_t i = 0; i < kOctaves.size(); ++i) {
            irradiance[i] /= weights[i];
        }
    }

    /// d log E / d log r, by least squares over the octaves.
    [[nodiscard]] double slope() const {
        const auto n = static_cast<double>(irradiance.size());
        double x = 0.0;
        double y = 0.0;
        double xx = 0.0;
        double xy = 0.0;
        for (std::size_t i = 0; i < irradiance.size(); ++i) {
            const double log_r = std::log(kOctaves[i].from);
            x += log_r / n;
            y += std::log(irradiance[i]) / n;
            xx += log_r * log_r / n;
            xy += log_r * std::log(irradiance[i]) / n;
        }
        return (xy - x * y) / (xx - x * x);
    }
};

Profile by_rays(const StarFilm& film) {
    return Profile([&](const auto& visit) {
        film.for_each([&](const Vec2d& place, double irradiance) {
            visit(length(place), irradiance, 1.0 / (kPixelsPerAiry * kPixelsPerAiry));
        });
    });
}

analysis::EdgeWave wave_of(const render::Camera& camera, int pieces) {
    const optics::Lens& lens = *camera.lens();
    const optics::StopAim aim(optics::at_wavelength<double>(lens, kWavelength_nm), lens.stop_index());
    return {aim, lens.stop_mask, {.at = {0.0, 0.0, 1.0}, .is_far = true}, kWavelength_nm, pieces};
}

/// A blade's sector is like the others, and its halves each other's mirror image: from a corner to the next edge's
/// normal, with steps that are short at both, where streaks are narrow.
Profile by_wave(const Setting& setting, const analysis::EdgeWave& wave) {
    const double half_sector = setting.blades > 0 ? kPi / setting.blades : kPi;
    const int azimuths = setting.blades > 0 ? 64 : 1;
    constexpr double kStep = 0.15;
    return Profile([&](const auto& visit) {
        for (double radius = 5.0 + 0.5 * kStep; radius < 100.0; radius += kStep) {
            for (int j = 0; j < azimuths; ++j) {
                const double t = (j + 0.5) / azimuths;
                const double azimuth = radians(kRotation_deg) + half_sector * t * t * (3.0 - 2.0 * t);
                const double share = azimuths == 1 ? 1.0 : 6.0 * t * (1.0 - t) / azimuths;
                const double r = radius * setting.airy_mm();
                visit(radius, wave.irradiance({r * std::cos(azimuth), r * std::sin(azimuth)}),
                      2.0 * kPi * radius * kStep * share);
            }
        }
    });
}

// From 5 to 100 λN: each octave within 10 % of the wave's, the slope within 5 %, all light together within 5 %. (Sixty
// thousand paths leave 1.5 % in the outermost octave; two million have every octave of a circle's within 0.5 %.)
void expect_the_waves_profile(const Setting& setting) {
    const StarFilm film(setting, 60'000);
    const Profile rays = by_rays(film);
    const Profile wave = by_wave(setting, wave_of(film.camera(), setting.blades > 0 ? 32 * setting.blades : 2048));
    double worst = 0.0;
    for (std::size_t i = 0; i < kOctaves.size(); ++i) {
        const double ratio = rays.irradiance[i] / wave.irradiance[i];
        EXPECT_NEAR(ratio, 1.0, 0.1) << setting.blades << " blades, from " << kOctaves[i].from << " λN";
        worst = std::max(worst, std::abs(ratio - 1.0));
    }
    EXPECT_NEAR(rays.slope() / wave.slope(), 1.0, 0.05);
    EXPECT_NEAR(rays.energy / wave.energy, 1.0, 0.05);
    fmt::print("{} blades, f/{}: octaves within {:.1f} %, slopes {:.3f} and {:.3f}, energies' ratio {:.4f}\n",
               setting.blades, setting.f_number, 100.0 * worst, rays.slope(), wave.slope(), rays.energy / wave.energy);
}

TEST(DiffractedLight, HasTheWavesProfile) {
    expect_the_waves_profile({.blades = 5, .f_number = 8.0});
    expect_the_waves_profile({.blades = 0, .f_number = 22.0});
}

// Streaks stand at right angles to the blades' edges, two for each of seven: each one's mean azimuth within 0.2°.
TEST(DiffractedLight, StandsAtRightAnglesToTheBlades) {
    constexpr int kBlades = 7;
    constexpr std::size_t kStreaks = 14;
    const StarFilm film({.blades = kBlades, .f_number = 22.0}, 60'000);
    std::vector<double> light(kStreaks);
    std::vector<double> turn(kStreaks);
    film.for_each([&](const Vec2d& place, double irradiance) {
        if (length(place) > 20.0) {
            const double sector = 180.0 / kBlades;
            const double azimuth = (degrees(std::atan2(place.y, place.x)) - kRotation_deg) / sector;
            const auto streak = static_cast<std::size_t>(std::lround(azimuth) + 14) % kStreaks;
            light[streak] += irradiance;
            turn[streak] += irradiance * sector * (azimuth - std::round(azimuth));
        }
    });
    const double most = *std::ranges::max_element(light);
    for (std::size_t i = 0; i < light.size(); ++i) {
        EXPECT_GT(light[i], 0.7 * most) << "streak " << i;
        EXPECT_NEAR(turn[i] / light[i], 0.0, 0.2) << "streak " << i;
    }
}

// Rays that come to the camera anyway and pass the stop in the zone beside its edges carry the light that is drawn at
// the edges themselves: here 10° off the axis, of a wide film, to four standard errors of 2 %.
TEST(DiffractedLight, IsTheSameOfRaysThatComeAnyway) {
    render::CameraSettings settings = tessar({.blades = 6, .f_number = 8.0, .curvature = 0.3}, 16);
    settings.sensor.pixel_pitch_mm = 4.0;
    const render::Camera camera(settings, {545.0, 555.0, 4, 1}, {}, {});
    const render::DiffractedEntrance entrance(camera, {.zone_width = 0.05});
    const Vec3d direction{std::sin(radians(10.0)), 0.0, -std::cos(radians(10.0))};
    const Basis across(direction);
    const spectral::PathWavelengths path = kGrid.path(0);
    constexpr int kRays = 200'000;
    constexpr int kDrawn = 20'000;
    constexpr double kSide = 16.0;  // mm, wider than the beam
    double drawn = 0.0;
    double met = 0.0;
    double met_squared = 0.0;
    const auto landed = [&](const std::optional<render::Entry>& entry) {
        double sum = 0.0;
        for (std::size_t i = 0; entry && i < entry->weight.size(); ++i) {
            const Vec2d px = entry->at_px[i];
            const bool is_inside = px.x > -0.5 && px.y > -0.5 && px.x < 15.5 && px.y < 15.5;
            sum += is_inside ? entry->weight[i] / entry->pdf : 0.0;
        }
        return sum;
    };
    // Straight through the middle of the stop, for where the beam is.
    const Vec3d middle = camera.to_world({{0.0, 0.0, 10.0}, {}}).origin - 100.0 * direction;
    for (std::uint32_t i = 0; i < kRays; ++i) {
        render::PathSampler numbers(1, 0, i);
        const auto u = numbers.next();
        if (i < kDrawn) {
            drawn += landed(entrance.draw({direction, true}, path, false, numbers)) / kDrawn;
        }
        const Vec3d from = middle + (kSide * (u[0] - 0.5)) * across.x + (kSide * (u[1] - 0.5)) * across.y;
        const double light = kSide * kSide * landed(entrance.meet({from, direction}, path, numbers));
        met += light / kRays;
        met_squared += light * light / kRays;
    }
    const double error = std::sqrt((met_squared - met * met) / kRays);
    fmt::print("drawn {:.4g} mm², met {:.4g} ± {:.2g}\n", drawn, met, error);
    EXPECT_LT(error, 0.02 * met);
    EXPECT_NEAR(met, drawn, 4.0 * error);
}

// What goes straight on is less by what is diffracted: of a circle Airy's tail beyond the first dark ring, 16.2 % by
// the wave, which the rays' P λ / (2 π² A θ) has as 2 / (π² · 1.22).
TEST(DiffractedLight, LeavesTheRestToTheImage) {
    const render::Camera camera(tessar({}, 16), {545.0, 555.0, 4, 1}, {}, {});
    const double share = render::DiffractedEntrance(camera).geometric_share();
    EXPECT_NEAR(share, 1.0 - 2.0 / (kPi * kPi * 1.22), 1e-12);
    EXPECT_NEAR(share, 0.838, 0.005);
    EXPECT_NEAR(render::DiffractedEntrance(camera, {.smallest_airy = 5.0}).geometric_share(), 0.95947, 1e-5);
}

// Beside the diffracted pass those that image lose what it takes, and it alone loses nothing.
TEST(DiffractedLight, IsTakenFromTheImage) {
    const render::Camera camera(tessar({.blades = 6, .f_number = 16.0}, 16), {545.0, 555.0, 4, 1}, {}, {}, true);
    const render::World world = SceneParts(kGrid).scene();
    const render::View view{.world = &world, .camera = &camera, .seed = 1, .paths = {}};
    const auto shares = [&](const std::vector<std::string>& names) {
        std::vector<double> found;
        for (const render::Render& render : render::renders_of(names, view, render::integrator_named("camera"))) {
            found.push_back(render.film.light_share);
        }
        return found;
    };
    const double share = render::DiffractedEntrance(camera).geometric_share();
    EXPECT_LT(share, 0.85);
    EXPECT_EQ(shares({"imaged", "diffracted", "direct"}), (std::vector<double>{share, 1.0, share}));
    EXPECT_EQ(shares({"imaged", "direct"}), (std::vector<double>{1.0, 1.0}));
    render::FilmLayout layout = camera.film();
    layout.light_share = share;
    render::Film film(layout);
    render::FilmTile tile(film.layout());
    film.load({.rect = {.width = 1, .height = 1}, .first = 0, .end = 1}, tile);
    tile.add(0, 0, 0, 2.0);
    tile.finish();
    film.store(tile);
    EXPECT_EQ(film.estimate(0, 0).rgb.y, film.layout().band_nm * 2.0 * share * film.layout().rgb_weights[0].y);
}

TEST(DiffractedLight, SaysWhatHasNoEdges) {
    render::CameraSettings ideal{.f_number = 8.0,
                                 .focus_distance_mm = kInfinity,
                                 .sensor = {.width = 16, .height = 16, .pixel_pitch_mm = 1.0},
                                 .response = "luminance",
                                 .model = render::LensModel::thin_lens,
                                 .focal_length_mm = 50.0};
    const render::Camera thin(ideal, {545.0, 555.0, 4, 1}, {}, {});
    EXPECT_THROW(render::DiffractedEntrance{thin}, InputError);
    render::CameraSettings cooke = tessar({.f_number = 8.0}, 16);
    cooke.lens = "triplet-cooke";  // its stop is a face of glass
    const render::Camera triplet(cooke, {545.0, 555.0, 4, 1}, {}, {});
    EXPECT_THROW(render::DiffractedEntrance{triplet}, InputError);
    const TestFolder folder;
    formats::Image open = formats::make_image(8, 8, {"R", "G", "B"});
    std::ranges::fill(open.pixels, 1.0F);
    formats::write_png(open, folder.path() / "iris.png");
    write_file(folder.path() / "textured.toml",
               read_file(formats::find_lens_file("tessar")) + "\n[stop]\ntexture = \"iris.png\"\n");
    render::CameraSettings textured = tessar({}, 16);
    textured.lens = (folder.path() / "textured.toml").string();
    const render::Camera pictured(textured, {545.0, 555.0, 4, 1}, {}, {});
    EXPECT_THROW(render::DiffractedEntrance{pictured}, InputError);
    const render::Camera camera(tessar({}, 16), {545.0, 555.0, 4, 1}, {}, {});
    EXPECT_THROW(render::DiffractedEntrance(camera, {.smallest_airy = 0.5}), InputError);
}

}  // namespace lensproof::diffracted_light_test
