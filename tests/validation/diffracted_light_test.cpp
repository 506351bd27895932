// Films of diffracted light, through a real lens, against the wave theory.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/angle.h"
#include "engine/base/basis.h"
#include "engine/base/file.h"
#include "engine/base/input_error.h"
#include "engine/base/write_file.h"
#include "engine/formats/image/image.h"
#include "engine/formats/prescription/prescription_file.h"
#include "engine/render/integrators/passes.h"
#include "engine/render/stray/diffracted_entrance.h"
#include "experiments/studies/edge_diffraction/measure_edges.h"
#include "tests/test_folder.h"
#include "tests/validation/rendered_scene.h"
#include "tests/validation/small_scene.h"

namespace lensproof::diffracted_light_test {

const spectral::SpectralGrid kGrid = spectral::spectral_grid(545.0, 555.0, 4);

struct Setting {
    int blades = 0;  // 0: a circle
    double f_number = 8.0;
    double curvature = 0.0;
};

render::CameraSettings tessar(const Setting& setting, int pixels) {
    render::CameraSettings camera{.lens = "tessar",
                                  .f_number = setting.f_number,
                                  .focus_distance_mm = kInfinity,
                                  .sensor = {.width = pixels, .height = pixels, .pixel_pitch_mm = 1e-3},
                                  .response = "luminance"};
    if (setting.blades > 0) {
        camera.blades =
            optics::PolygonStop{.blades = setting.blades, .curvature = setting.curvature, .rotation_deg = 10.0};
    }
    return camera;
}

/// The same with a picture for its stop, whose brightness is the mean over each texel.
template <class Brightness>
render::CameraSettings textured_tessar(const TestFolder& folder, int texels, const Brightness& brightness) {
    formats::Image picture = formats::make_image(texels, texels, {"Y"});
    constexpr int kFine = 8;
    for (int y = 0; y < texels * kFine; ++y) {
        for (int x = 0; x < texels * kFine; ++x) {
            const double fine = 2.0 / (texels * kFine);
            const int texel = y / kFine * texels + x / kFine;
            picture.pixels[static_cast<std::size_t>(texel)] +=
                static_cast<float>(brightness((x + 0.5) * fine - 1.0, 1.0 - (y + 0.5) * fine) / (kFine * kFine));
        }
    }
    formats::write_exr(picture, folder.path() / "iris.exr");
    write_file(folder.path() / "textured.toml",
               read_file(formats::find_lens_file("tessar")) + "\n[stop]\ntexture = \"iris.exr\"\n");
    render::CameraSettings textured = tessar({}, 16);
    textured.lens = (folder.path() / "textured.toml").string();
    return textured;
}

/// What an entrance draws of a star on the axis, by deflections of some λN.
struct Drawn {
    std::array<double, 3> octaves{};    // from 5, 10 and 20 to twice as many
    std::array<double, 6> by_streak{};  // beyond 10, of which six streaks the light is nearest to
    double straight = 0.0;              // within 10° of these
};

Drawn drawn(const render::CameraSettings& settings) {
    const render::Camera camera(settings, {545.0, 555.0, 4, 1}, {}, {});
    const render::DiffractedEntrance entrance(camera);
    const double airy_px = 0.546e-3 * settings.f_number / settings.sensor.pixel_pitch_mm;
    Drawn found;
    constexpr int kDraws = 100'000;
    for (std::uint32_t i = 0; i < kDraws; ++i) {
        render::PathSampler numbers(1, 0, i);
        const auto entry = entrance.draw({{0.0, 0.0, -1.0}, true}, kGrid.path(0), false, numbers);
        if (!entry || !(entry->weight[0] > 0.0)) {
            continue;
        }
        const Vec2d off = entry->at_px[0] - Vec2d{7.5, 7.5};
        const double distance = length(off) / airy_px;
        const double light = entry->weight[0] / entry->pdf / kDraws;
        for (std::size_t k = 0; k < found.octaves.size(); ++k) {
            const double from = 5.0 * std::exp2(static_cast<double>(k));
            found.octaves.at(k) += distance >= from && distance < 2.0 * from ? light : 0.0;
        }
        if (distance >= 10.0 && distance < 100.0) {
            const double turn = (std::atan2(-off.y, -off.x) * 180.0 / kPi + 360.0 - 40.0) / 60.0;
            const double nearest = std::round(turn);
            found.by_streak.at(static_cast<std::size_t>(nearest) % 6) += light;
            found.straight += std::abs(turn - nearest) * 60.0 < 10.0 ? light : 0.0;
        }
    }
    return found;
}

// A picture of six blades diffracts as six blades do, each as much and in the same direction; one of a round stop as a
// circle does. 512 texels know the edges' length to half a percent; 100,000 draws leave one to two.
TEST(DiffractedLight, OfAPictureIsThatOfWhatItShows) {
    const TestFolder folder;
    const auto six_blades = [](double x, double y) {
        double margin = -1.0;
        for (int i = 0; i < 6; ++i) {
            const double azimuth = radians(40.0 + 60.0 * i);
            margin = std::max(margin, x * std::cos(azimuth) + y * std::sin(azimuth) - std::cos(kPi / 6.0));
        }
        return margin <= 0.0 ? 1.0 : 0.0;
    };
    const auto round = [](double x, double y) { return std::hypot(x, y) <= 1.0 ? 1.0 : 0.0; };
    const auto expect_alike = [](const Drawn& pictured, const Drawn& stated) {
        for (std::size_t i = 0; i < stated.octaves.size(); ++i) {
            EXPECT_NEAR(pictured.octaves.at(i) / stated.octaves.at(i), 1.0, 0.06) << i;
        }
        const auto sum = [](const Drawn& of) { return std::accumulate(of.by_streak.begin(), of.by_streak.end(), 0.0); };
        for (std::size_t i = 0; i < stated.by_streak.size(); ++i) {
            EXPECT_NEAR(pictured.by_streak.at(i) / sum(pictured), stated.by_streak.at(i) / sum(stated), 0.02) << i;
        }
        EXPECT_NEAR(pictured.straight / sum(pictured), stated.straight / sum(stated), 0.02);
    };
    expect_alike(drawn(textured_tessar(folder, 512, six_blades)), drawn(tessar({.blades = 6}, 16)));
    expect_alike(drawn(textured_tessar(folder, 512, round)), drawn(tessar({}, 16)));
}

// From 5 to 100 λN: each octave within 10 % of the wave's, the slope within 5 %, all light together within 5 %. (Sixty
// thousand paths leave 1.5 % in the outermost octave; two million have every octave of a circle's within 0.5 %.)
TEST(DiffractedLight, HasTheWavesProfile) {
    constexpr int kPaths = 60'000;
    for (const studies::EdgeSetting& setting :
         {studies::EdgeSetting{.lens = "tessar", .f_number = 8.0, .blades = 5, .paths = kPaths, .has_maps = false},
          studies::EdgeSetting{.lens = "tessar", .f_number = 22.0, .blades = 0, .paths = kPaths, .has_maps = false}}) {
        const studies::EdgeDiffraction found = studies::measure_edges(setting, 1);
        for (std::size_t i = 0; i < studies::kOctaves.size(); ++i) {
            EXPECT_NEAR(found.rays.profile.octaves[i] / found.wave.octaves[i], 1.0, 0.1)
                << setting.blades << " blades, from " << studies::kOctaves.at(i) << " λN";
        }
        EXPECT_NEAR(found.rays.profile.slope() / found.wave.slope(), 1.0, 0.05);
        EXPECT_NEAR(found.rays.profile.energy / found.wave.energy, 1.0, 0.05);
    }
}

// Streaks stand at right angles to the blades' edges, two for each of seven and one for each of six: each one's mean
// azimuth within 0.2°.
TEST(DiffractedLight, StandsAtRightAnglesToTheBlades) {
    for (const auto& [blades, streaks] : {std::pair(7, 14U), std::pair(6, 6U)}) {
        const studies::EdgeDiffraction found = studies::measure_edges(
            {.lens = "tessar", .f_number = 22.0, .blades = blades, .paths = 60'000, .has_maps = false}, 1);
        ASSERT_EQ(found.rays.streaks.size(), streaks);
        for (const studies::Streak& streak : found.rays.streaks) {
            EXPECT_GT(streak.light, 0.7);
            EXPECT_NEAR(streak.turn_deg, 0.0, 0.2) << blades << " blades";
        }
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
    const double fraction = render::DiffractedEntrance(camera).geometric_fraction();
    EXPECT_NEAR(fraction, 1.0 - 2.0 / (kPi * kPi * 1.22), 1e-12);
    EXPECT_NEAR(fraction, 0.838, 0.005);
    EXPECT_NEAR(render::DiffractedEntrance(camera, {.smallest_airy = 5.0}).geometric_fraction(), 0.95947, 1e-5);
}

// Beside the diffracted pass those that image lose what it takes, and it alone loses nothing.
TEST(DiffractedLight, IsTakenFromTheImage) {
    const render::Camera camera(tessar({.blades = 6, .f_number = 16.0}, 16), {545.0, 555.0, 4, 1}, {}, {}, true);
    const render::World world = SceneParts(kGrid).scene();
    const render::View view{.world = &world, .camera = &camera, .seed = 1, .paths = {}};
    const auto fractions = [&](const std::vector<std::string>& names) {
        std::vector<double> found;
        for (const render::Render& render : render::renders_of(names, view, {})) {
            found.push_back(render.film.kept_fraction);
        }
        return found;
    };
    const double fraction = render::DiffractedEntrance(camera).geometric_fraction();
    EXPECT_LT(fraction, 0.85);
    EXPECT_EQ(fractions({"imaged", "diffracted", "direct"}), (std::vector<double>{fraction, 1.0, fraction}));
    EXPECT_EQ(fractions({"imaged", "direct"}), (std::vector<double>{1.0, 1.0}));
    render::FilmLayout layout = camera.film();
    layout.kept_fraction = fraction;
    render::Film film(layout);
    render::FilmTile tile(film.layout());
    film.load({.rect = {.width = 1, .height = 1}, .first = 0, .end = 1}, tile);
    tile.add(0, 0, 0, 2.0);
    tile.finish();
    film.store(tile);
    EXPECT_EQ(film.estimate(0, 0).rgb.y, film.layout().band_nm * 2.0 * fraction * film.layout().rgb_weights[0].y);
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
    const render::Camera soft(textured_tessar(folder, 64, [](double x, double y) { return 1.0 - std::hypot(x, y); }),
                              {545.0, 555.0, 4, 1}, {}, {});
    EXPECT_THROW(render::DiffractedEntrance{soft}, InputError);
    const render::Camera camera(tessar({}, 16), {545.0, 555.0, 4, 1}, {}, {});
    EXPECT_THROW(render::DiffractedEntrance(camera, {.smallest_airy = 0.5}), InputError);
}

}  // namespace lensproof::diffracted_light_test
