// How bright the scene renderer makes an even scene through a lens: furnaces and Lambertian planes against solid
// angles.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "engine/analysis/lens_analysis.h"
#include "engine/base/angle.h"
#include "engine/base/write_file.h"
#include "engine/formats/image/image.h"
#include "engine/formats/prescription/load_lens.h"
#include "engine/optics/chief_ray.h"
#include "engine/optics/focus.h"
#include "engine/optics/illumination.h"
#include "engine/spectral/illuminant.h"
#include "tests/complaint.h"
#include "tests/test_folder.h"
#include "tests/validation/rendered_scene.h"

namespace lensproof::lens_exposure_test {

constexpr int kSeeds = 8;
constexpr double kLuminance = 1000.0;
const std::vector<double> kWavelengths{456.25, 518.75, 581.25, 643.75};  // the middles of four layers over 425 … 675 nm
constexpr render::Sensor kSensor{.width = 421, .height = 1, .pixel_pitch_mm = 0.1};

/// A camera that looks along +z at whatever stands there, lit by an even sky.
render::SceneSetup setup_of(const std::string& camera, const std::string& objects) {
    return render::parse_scene_setup(
        fmt::format("[camera]\n{}\nposition_mm = [0, 0, 0]\nlook_at_mm = [0, 0, 1]\nsensor_mm = [{}, {}]\n"
                    "pixels = [{}, {}]\nshutter_s = 0.01\niso = 100\nresponse = \"luminance\"\n{}\n"
                    "[[lights]]\nkind = \"environment\"\nluminance_cd_m2 = {}\nilluminant = \"E\"\n"
                    "[render]\nmax_bounces = 200\nlayers = 4\nstrata_per_layer = 1\nwavelengths_nm = [425, 675]\n",
                    camera, kSensor.width * kSensor.pixel_pitch_mm, kSensor.pixel_pitch_mm, kSensor.width,
                    kSensor.height, objects, kLuminance),
        "even.toml");
}

/// Film irradiance over the radiance of the sky, sr: [pixel][wavelength]. The pixels are `columns` of the sensor.
std::vector<std::array<Measured, 4>> exposures(const render::SceneSetup& setup, const std::vector<int>& columns,
                                               std::uint32_t samples) {
    const render::PreparedScene scene(setup, {}, {});
    const spectral::Spectrum radiance = spectral::radiance_of(spectral::illuminant("E"), kLuminance);
    std::vector<render::PixelRect> windows;
    windows.reserve(columns.size());
    for (const int column : columns) {
        windows.push_back({column, 0, 1, 1});
    }
    std::vector<std::array<std::vector<double>, 4>> found(columns.size());
    for (int seed = 0; seed < kSeeds; ++seed) {
        const render::Film film = rendered(scene.render(static_cast<std::uint64_t>(seed), false), windows, samples);
        for (std::size_t i = 0; i < columns.size(); ++i) {
            std::array<double, 4> layers{};
            film.layers(columns[i], 0, layers);
            for (std::size_t k = 0; k < layers.size(); ++k) {
                found[i][k].push_back(layers[k] / radiance(kWavelengths[k]));
            }
        }
    }
    std::vector<std::array<Measured, 4>> means(columns.size());
    for (std::size_t i = 0; i < columns.size(); ++i) {
        std::ranges::transform(found[i], means[i].begin(), [](const auto& values) { return mean_of(values); });
    }
    return means;
}

double height_mm(int column) {
    return std::abs(kSensor.position(column, 0.0).x);
}

/// Eight standard errors of eight seeds, which one of 10 000 numbers exceeds (Student's t), and a fraction of the
/// number.
void expect_measured(const Measured& found, double expected, double fraction) {
    EXPECT_NEAR(found.value, expected, 8.0 * found.error + fraction * expected);
    EXPECT_LT(found.error, 0.004 * expected);
}

const std::vector<int> kColumns{210, 310, 370, 410};  // the axis, 10, 16 and 20 mm beside it

const std::string kDoubleGauss = "lens = \"double-gauss-tronnier\"\nf_number = 2.8\nfocus_distance_mm = 2000";
const optics::Lens& double_gauss() {
    static const optics::Lens lens =
        optics::focused_at(optics::with_f_number(formats::load_lens("double-gauss-tronnier"), 2.8), 2000.0);
    return lens;
}

// In an even sky, which white things of any shape do not disturb, a film point's irradiance is L ∫ τ dΩ_p: the sky's
// radiance times the projected solid angle of the bundle that reaches it through every rim, weighed with the
// transmittance of each ray: without losses π / (4 N²) on the axis, N being the working f-number. That is found here by
// quadrature over the bundle's outline, without any sampler.
TEST(LensExposure, WhiteFurnaceStaysWhiteThroughTheLens) {
    const std::string white =
        "[[materials]]\nname = \"white\"\nkind = \"diffuse\"\nreflectance = 1.0\n"
        "[[objects]]\nshape = \"sphere\"\nradius_mm = 400\ntranslate_mm = [300, 0, 2000]\nmaterial = \"white\"\n"
        "[[objects]]\nshape = \"quad\"\nsize_mm = [9000, 9000]\nrotate_deg = [0, 180, 0]\n"
        "translate_mm = [0, 0, 3000]\nmaterial = \"white\"\n";
    const auto found = exposures(setup_of(kDoubleGauss, white), kColumns, 4096);
    for (std::size_t i = 0; i < kColumns.size(); ++i) {
        for (std::size_t k = 0; k < kWavelengths.size(); ++k) {
            const optics::Bundle bundle = optics::image_bundle(
                optics::at_wavelength<double>(double_gauss(), kWavelengths[k]), height_mm(kColumns[i]));
            fmt::print("{:.1f} mm, {} nm: {:.5f} ± {:.5f} sr, traced {:.5f}, of which passes {:.3f}\n",
                       height_mm(kColumns[i]), kWavelengths[k], found[i][k].value, found[i][k].error,
                       bundle.transmitted, bundle.transmitted / bundle.projected_solid_angle);
            // Roulette ends no path for good, 200 bounces end hardly any; a float's weights round by 1e-6.
            expect_measured(found[i][k], bundle.transmitted, 1e-4);
        }
    }
}

/// Of the chief ray that reaches this height from a plane at 2 m, by secants.
double field_deg_of(const optics::ChiefRays& chiefs, double height) {
    double object = 40.0 * height;  // about where a lens of 50 mm images it
    double before = 0.0;
    double height_before = 0.0;
    for (int step = 0; step < 20; ++step) {
        const double reached = chiefs.from_point(-object, -2000.0).value().image_height;
        if (std::abs(reached - height) < 1e-9) {
            break;
        }
        const double next = object + (height - reached) * (object - before) / (reached - height_before);
        before = object;
        height_before = reached;
        object = next;
    }
    return degrees(chiefs.from_point(-object, -2000.0).value().field_angle);
}

// A matt plane across the axis that an even sky lights has the radiance ρ L, the same in every direction. Its image
// falls off from the axis as `analyze` says (relative illumination) times the transmittance of the field's rays.
TEST(LensExposure, MattPlaneFallsOffAsAnalyzeSays) {
    const std::string plane =
        "[[materials]]\nname = \"matt\"\nkind = \"diffuse\"\nreflectance = 0.4\n"
        "[[objects]]\nshape = \"quad\"\nsize_mm = [4000, 4000]\nrotate_deg = [0, 180, 0]\ntranslate_mm = [0, 0, 2000]\n"
        "material = \"matt\"\n";
    const auto found = exposures(setup_of(kDoubleGauss, plane), kColumns, 2048);
    const double reference_nm = kWavelengths[2];
    const optics::TraceLens<double> traced = optics::at_wavelength<double>(double_gauss(), reference_nm);
    const optics::ChiefRays chiefs(double_gauss(), reference_nm);
    const optics::Bundle axis = optics::image_bundle(traced, 0.0);
    for (std::size_t i = 1; i < kColumns.size(); ++i) {
        const double height = height_mm(kColumns[i]);
        const double field = field_deg_of(chiefs, height);
        const analysis::LensAnalysis analysis =
            analysis::analyze_lens(double_gauss(), {.wavelengths_nm = {reference_nm},
                                                    .reference_wavelength_nm = reference_nm,
                                                    .fields_deg = {field},
                                                    .object_distance = 2000.0});
        const optics::Bundle bundle = optics::image_bundle(traced, height);
        const double passing = bundle.transmitted / bundle.projected_solid_angle;
        const double passing_axis = axis.transmitted / axis.projected_solid_angle;
        const double expected = analysis.fields[0].relative_illumination.value() * passing / passing_axis;
        const double ratio = found[i][2].value / found[0][2].value;
        const double error =
            ratio * std::hypot(found[i][2].error / found[i][2].value, found[0][2].error / found[0][2].value);
        const double cos = std::cos(radians(field));
        fmt::print("{:.1f} mm, {:.2f}°: {:.4f} ± {:.4f} of the axis, by analyze {:.4f}; cos⁴ {:.4f}\n", height, field,
                   ratio, error, expected, std::pow(cos, 4));
        expect_measured({ratio, error}, expected, 1e-4);
        expect_measured(found[0][2], 0.4 * axis.transmitted, 1e-4);
    }
}

// Seven straight blades leave of the stop's circle 7 / (2π) sin(2π / 7) = 0.871, and of the light on the axis as much,
// where the lens is stopped down so far that pupils are images of the stop to scale: the irradiance of the rim's rays
// is less than the middle's by cos⁴ of 3.5° of their angle, a percent, of which the ratio sees a tenth.
TEST(LensExposure, BladesLeaveTheirPolygonsShare) {
    const std::string camera = "lens = \"double-gauss-tronnier\"\nf_number = 8\nfocus_distance_mm = 2000\n";
    const auto round = exposures(setup_of(camera, ""), {210}, 4096)[0][2];
    const auto bladed = exposures(setup_of(camera + "blades = 7\nblade_rotation_deg = 10", ""), {210}, 4096)[0][2];
    const auto curved = exposures(setup_of(camera + "blades = 7\nblade_curvature = 1.0", ""), {210}, 4096)[0][2];
    const double fraction = 7.0 / (2.0 * kPi) * std::sin(2.0 * kPi / 7.0);
    expect_measured(bladed, fraction * round.value, 2e-3);
    expect_measured(curved, round.value, 2e-3);
}

TEST(LensExposure, BladesWithoutALensOrANumberAreRefused) {
    const auto message = [](const std::string& camera) { return complaint_about([&] { setup_of(camera, ""); }); };
    EXPECT_TRUE(says(message(kDoubleGauss + "\nmodel = \"thin-lens\"\nblades = 7"), "thin-lens"));
    EXPECT_TRUE(says(message(kDoubleGauss + "\nblade_rotation_deg = 7"), "blade_rotation_deg"));
    EXPECT_TRUE(says(message(kDoubleGauss + "\nblades = 2"), "blades"));
}

// A camera's walls stand in the place of its lens's; ideal models have none.
TEST(LensExposure, CamerasStateTheirBarrel) {
    EXPECT_TRUE(render::camera_lens(setup_of(kDoubleGauss, "").camera).barrel.is_black());
    const auto grey = render::camera_lens(setup_of(kDoubleGauss + "\nbarrel = { albedo = 0.1 }", "").camera);
    EXPECT_EQ(grey.barrel.edges.albedo, 0.1);
    const auto message = [](const std::string& camera) { return complaint_about([&] { setup_of(camera, ""); }); };
    EXPECT_TRUE(says(message(kDoubleGauss + "\nmodel = \"thin-lens\"\nbarrel = { albedo = 0.1 }"), "thin-lens"));
    EXPECT_TRUE(says(message(kDoubleGauss + "\nbarrel = { albedo = 2 }"), "barrel.albedo"));
}

// Even haze on the front takes its share everywhere; grains on half of it take half of the light on the axis, to what
// 4096 samples say. Ideal models have no front.
TEST(LensExposure, DustTakesWhatItCovers) {
    const TestFolder folder;
    const auto lens_with = [&](const std::vector<float>& covered) {
        formats::Image picture = formats::make_image(static_cast<int>(covered.size()), 1, {"Y"});
        picture.pixels = covered;
        formats::write_exr(picture, folder.path() / "dust.exr");
        return fmt::format("{}\ndust = {{ picture = \"{}\", albedo = 0.5 }}", kDoubleGauss,
                           (folder.path() / "dust.exr").string());
    };
    const auto light = [&](const std::string& camera) { return exposures(setup_of(camera, ""), {210}, 4096)[0][2]; };
    const auto clean = light(kDoubleGauss);
    expect_measured(light(lens_with({0.25F})), 0.75 * clean.value, 2e-3);
    expect_measured(light(lens_with({1.0F, 0.0F})), 0.5 * clean.value, 2e-3);
    const auto message = [](const std::string& camera) { return complaint_about([&] { setup_of(camera, ""); }); };
    EXPECT_TRUE(says(message(lens_with({1.0F}) + "\nmodel = \"thin-lens\""), "no front"));
    EXPECT_TRUE(says(message(kDoubleGauss + "\ndust = { picture = \"none.png\", albedo = 0.5 }"), "none.png"));
    EXPECT_TRUE(says(message(kDoubleGauss + "\ndust = { albedo = 0.5 }"), "picture"));
}

// White grains that send all light on lose none: under an even sky the film has from them what it has from the glass
// that they cover, since what glass under a grain sends back goes out through it, and there is as much sky there.
// (Coated, so that ghosts, which take the same ways in, add less than a percent of a percent for each pair of
// surfaces.)
TEST(LensExposure, WhiteDustUnderAnEvenSkyChangesNothing) {
    const TestFolder folder;
    formats::Image haze = formats::make_image(1, 1, {"Y"});
    haze.pixels = {0.4F};
    formats::write_exr(haze, folder.path() / "haze.exr");
    const std::string picture = (folder.path() / "haze.exr").string();
    render::PreparedScene scene(
        setup_of(fmt::format("{}\ncoating = \"broadband\"\ndust = {{ picture = \"{}\", albedo = 1, through = 1 }}",
                             kDoubleGauss, picture),
                 ""),
        {}, {});
    const render::PixelRect middle{210, 0, 1, 1};
    const auto light = [&](const std::vector<std::string>& passes, std::uint32_t samples) {
        std::vector<double> seeds;
        for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
            double sum = 0.0;
            for (const render::Render& render : scene.render(passes, seed, false)) {
                sum += rendered(render, {&middle, 1}, samples).estimate(210, 0).rgb.y;
            }
            seeds.push_back(sum);
        }
        return mean_of(seeds);
    };
    const Measured clean = light({"imaged", "direct"}, 4096);  // less by two fifths
    const Measured dust = light({"barrel"}, 40000);
    fmt::print("{:.5g} ± {:.2g} of {:.5g}\n", dust.value / clean.value, dust.error / clean.value, 0.4 / 0.6);
    EXPECT_NEAR(dust.value / clean.value, 0.4 / 0.6, 4.0 * dust.error / clean.value);
    EXPECT_LT(dust.error, 0.01 * dust.value);
}

// Through a pinhole the same plane falls off as cos⁴θ. Through a thin lens it does as a disc of radius a seen from the
// film at the distance s does (Foote, Bull. Bur. Standards 12, 1915): E = π L / 2 · (1 − (1 + tan²θ − tan²α) /
// √(tan⁴θ + 2 tan²θ (1 − tan²α) + 1 / cos⁴α)), tan α = a / s.
TEST(LensExposure, IdealCamerasFallOffByTheirFormulas) {
    constexpr double kFocal = 35.0;
    constexpr double kFNumber = 1.4;
    const std::string plane =
        "[[materials]]\nname = \"matt\"\nkind = \"diffuse\"\nreflectance = 0.4\n"
        "[[objects]]\nshape = \"quad\"\nsize_mm = [9000, 9000]\nrotate_deg = [0, 180, 0]\ntranslate_mm = [0, 0, 2000]\n"
        "material = \"matt\"\n";
    const std::string settings =
        fmt::format("focal_length_mm = {}\nf_number = {}\nfocus_distance_mm = 2000", kFocal, kFNumber);
    const double film = 1.0 / (1.0 / kFocal - 1.0 / 2000.0);
    const double radius = 0.5 * kFocal / kFNumber;
    const double tan2a = radius * radius / (film * film);
    const auto pinhole = exposures(setup_of("model = \"pinhole\"\n" + settings, plane), kColumns, 1024);
    const auto thin = exposures(setup_of("model = \"thin-lens\"\n" + settings, plane), kColumns, 1024);
    for (std::size_t i = 0; i < kColumns.size(); ++i) {
        const double tan2 = std::pow(height_mm(kColumns[i]) / film, 2);
        const double cos4 = 1.0 / ((1.0 + tan2) * (1.0 + tan2));
        const double disc = 0.5 * kPi *
                            (1.0 - (1.0 + tan2 - tan2a) / std::sqrt(tan2 * tan2 + 2.0 * tan2 * (1.0 - tan2a) +
                                                                    (1.0 + tan2a) * (1.0 + tan2a)));
        fmt::print("{:.1f} mm: pinhole {:.5f} ± {:.5f} sr, cos⁴ {:.5f}; thin lens {:.5f} ± {:.5f}, Foote {:.5f}\n",
                   height_mm(kColumns[i]), pinhole[i][0].value, pinhole[i][0].error, 0.4 * kPi * tan2a * cos4,
                   thin[i][0].value, thin[i][0].error, 0.4 * disc);
        for (std::size_t k = 0; k < kWavelengths.size(); ++k) {
            expect_measured(pinhole[i][k], 0.4 * kPi * tan2a * cos4, 1e-4);
            expect_measured(thin[i][k], 0.4 * disc, 1e-4);
        }
    }
}

// A paraboloid sends the light of its rim to the focus at tan(U/2) = r / (2 f), a reflection on: the film in front of
// it gets L π sin² U, and half of that where the mirror keeps half. Behind two mirrors it is the bundle's, as through
// glass.
TEST(LensExposure, MirrorsFillTheConesThatTheySend) {
    const TestFolder folder;
    const auto camera_of = [&](const std::string& name, const std::string& surfaces) {
        const std::filesystem::path file = folder.path() / (name + ".toml");
        write_file(file, fmt::format("name = \"{}\"\nsource = \"closed form\"\nsurfaces = [\n{}]\n"
                                     "[coatings.half]\nreflectance = 0.5\n",
                                     name, surfaces));
        return fmt::format("lens = \"{}\"\nf_number = {}\nfocus_distance_mm = inf", file.string(),
                           name == "prime" ? 2.0 : 8.0);
    };
    const std::string prime = camera_of(
        "prime",
        "{ stop = true, radius_mm = -200, conic = -1, thickness_mm = -100, semi_diameter_mm = 25, mirror = true, "
        "coating = \"half\" },\n");
    const std::string cassegrain = camera_of(
        "cassegrain",
        "{ stop = true, radius_mm = -200, conic = -1, thickness_mm = -70, semi_diameter_mm = 25, mirror = true },\n"
        "{ radius_mm = -80, conic = -2.7777777777777777, thickness_mm = 120, semi_diameter_mm = 9, mirror = true },\n");
    const double sine = std::sin(2.0 * std::atan(25.0 / 200.0));
    const auto at_prime = exposures(setup_of(prime, ""), {210}, 4096);
    const optics::Lens two = formats::load_lens((folder.path() / "cassegrain.toml").string());
    const optics::Bundle bundle = optics::image_bundle(optics::at_wavelength<double>(two, kWavelengths[0]), 0.0);
    const auto at_second = exposures(setup_of(cassegrain, ""), {210}, 4096);
    // Over a pixel of 0.1 mm both stay as on the axis, to the square of 0.05 mm over the focal length.
    for (std::size_t k = 0; k < kWavelengths.size(); ++k) {
        expect_measured(at_prime[0][k], 0.5 * std::numbers::pi * sine * sine, 1e-5);
        expect_measured(at_second[0][k], bundle.projected_solid_angle, 1e-5);
    }
    EXPECT_NEAR(bundle.projected_solid_angle, std::numbers::pi / (4.0 * 8.0 * 8.0),
                2e-3 * bundle.projected_solid_angle);
}

}  // namespace lensproof::lens_exposure_test
