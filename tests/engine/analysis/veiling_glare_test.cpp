// The veiling glare index against a plate's closed form, the ghosts one by one, and walls that add to it.
#include "engine/analysis/veiling_glare.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "engine/base/input_error.h"
#include "engine/formats/prescription/load_lens.h"
#include "engine/optics/stray_walk.h"
#include "engine/pupil/rear_disc.h"

namespace lensproof::analysis::veiling_glare_test {

constexpr double kWavelength = 587.5618;

// A plate before a pinhole: of each direction R² of the light comes by way of two reflections or more, T² R² + T² R⁴ +
// … over T² + T² R² + …. The spot hides half of the pinhole from the sensor. Light is 1.1° off the axis at most: R and
// cos⁴ vary by a thousandth.
TEST(VeilingGlare, PlateGivesWhatItsReflectanceSays) {
    optics::Prescription prescription;
    prescription.surfaces = {
        {.thickness_mm = 3.0, .semi_diameter_mm = 20.0, .medium = {.n_d = 2.0}},
        {.thickness_mm = 5.0, .semi_diameter_mm = 20.0},
        {.thickness_mm = 50.0, .semi_diameter_mm = 1.0, .is_stop = true},
    };
    const double r2 = std::pow(1.0 / 3.0, 4);
    const VeilingGlare glare = veiling_glare(
        optics::make_lens(prescription, {}),
        {.wavelength_nm = kWavelength, .spot_angle = std::atan(std::sqrt(0.5) / 50.0), .paths = 100'000, .threads = 1});
    EXPECT_NEAR(glare.ghosts.fraction, 0.5 * r2, 4.0 * glare.ghosts.standard_error);
    EXPECT_LT(glare.ghosts.standard_error, 0.05 * r2);
    EXPECT_NEAR(glare.blur.fraction, 0.5 * (1.0 - r2), 4.0 * glare.blur.standard_error + 5e-4);
    EXPECT_EQ(glare.barrel.fraction, 0.0);
    EXPECT_NEAR(glare.index.fraction, glare.ghosts.fraction + glare.blur.fraction, 1e-12);
    const double even = std::numbers::pi * std::pow(std::sin(std::atan(1.0 / 50.0)), 2) * (1.0 - 1.0 / 9.0) /
                        (1.0 + 1.0 / 9.0);  // π sin² u (1 − R) / (1 + R)
    EXPECT_NEAR(glare.irradiance, even, 0.01 * even);
}

// The same plate at a slant, where s is reflected more than p: each polarisation keeps to itself, and of the sums over
// both, T² R² + T² R⁴ + … over T² + T² R² + …, more is ghosts than by the mean reflectance. The spot hides half.
TEST(VeilingGlare, PolarisationOfASlantedPlate) {
    constexpr double kTilt_deg = 55.0;
    optics::Prescription prescription;
    prescription.surfaces = {
        {.thickness_mm = 3.0, .semi_diameter_mm = 50.0, .medium = {.n_d = 2.0}},
        {.thickness_mm = 60.0, .semi_diameter_mm = 50.0},
        {.thickness_mm = 50.0, .semi_diameter_mm = 1.0, .is_stop = true},
    };
    for (const std::size_t face : {0U, 1U}) {
        prescription.surfaces[face].misalignment.tilt_deg = {kTilt_deg, 0.0, 0.0};
    }
    const VeilingGlare glare =
        veiling_glare(optics::make_lens(prescription, {}), {.wavelength_nm = kWavelength,
                                                            .spot_angle = std::atan(std::sqrt(0.5) / 50.0),
                                                            .polarised = true,
                                                            .paths = 200'000,
                                                            .threads = 1});
    const double incidence = kTilt_deg * std::numbers::pi / 180.0;
    const double inside = std::asin(std::sin(incidence) / 2.0);
    const double r_s = std::pow(std::sin(incidence - inside) / std::sin(incidence + inside), 2);  // Born & Wolf, §1.5.2
    const double r_p = std::pow(std::tan(incidence - inside) / std::tan(incidence + inside), 2);
    const auto all = [](double r) { return (1.0 - r) / (1.0 + r); };
    const double carried = (all(r_s) * r_s * r_s + all(r_p) * r_p * r_p) / (all(r_s) + all(r_p));
    const double averaged = std::pow((r_s + r_p) / 2.0, 2);
    ASSERT_TRUE(glare.polarised);
    const PolarisedGlare& polarised = *glare.polarised;
    EXPECT_GT(carried, 1.2 * averaged);
    EXPECT_LT(polarised.ghosts.standard_error, 0.05 * carried);
    EXPECT_NEAR(glare.ghosts.fraction, 0.5 * averaged, 4.0 * glare.ghosts.standard_error);
    EXPECT_NEAR(polarised.ghosts.fraction, 0.5 * carried, 4.0 * polarised.ghosts.standard_error);
    EXPECT_NEAR(polarised.index.fraction, polarised.ghosts.fraction + polarised.blur.fraction, 1e-12);
    EXPECT_NEAR(polarised.difference.fraction, polarised.index.fraction - glare.index.fraction, 1e-12);
    EXPECT_LT(polarised.difference.standard_error, polarised.index.standard_error);
}

/// From the image's centre towards the rear of the lens, evenly over a disc that holds it.
class FromCentre {
  public:
    explicit FromCentre(const optics::TraceLens<double>& lens)
        : disc_(pupil::rear_disc(lens, 0.0)), image_z_(lens.image_z) {}

    double number() { return uniform_(random_); }
    Ray<double> ray() {
        const double u = number();
        const Vec2d place = disc_.warped(u, number());
        return {{0.0, 0.0, image_z_}, normalized(Vec3d{place.x, place.y, disc_.plane_z - image_z_})};
    }

  private:
    pupil::RearDisc disc_;
    double image_z_;
    std::mt19937_64 random_{3};
    std::uniform_real_distribution<double> uniform_{0.0, 1.0};
};

// Of a Tessar's paths those that two surfaces reflect carry what each pair of surfaces does, followed by itself; both
// counted over the light that goes straight through. The rest of the glare is light from far beside the field that
// meets two total reflections more: a bright half space holds much of that.
TEST(VeilingGlare, GhostsAreThoseOfAllPairsAndMore) {
    const optics::Lens lens = formats::load_lens("tessar");
    const double spot = tenth_of_field(lens, kWavelength);
    const optics::TraceLens<double> at = optics::at_wavelength<double>(lens, kWavelength);
    const auto is_beside = [&](const Vec3d& out) { return std::hypot(out.x, out.y) > std::sin(spot); };
    const auto count = static_cast<int>(at.surfaces.size());
    FromCentre centre(at);
    double pairs = 0.0;
    double image = 0.0;
    for (int i = 0; i < 3000; ++i) {
        const Ray<double> ray = centre.ray();
        const auto follow = [&](const optics::GhostPath& path) {
            const auto out = optics::trace_ghost<optics::Direction::reverse>(at, path, ray);
            const bool counts = out.status == optics::RayStatus::ok && (path.empty() || is_beside(out.ray.direction));
            return counts ? std::pow(ray.direction.z, 4) * out.transmittance : 0.0;
        };
        image += follow({});
        for (int first = 0; first < count; ++first) {
            for (int second = first + 1; second < count; ++second) {
                pairs += follow({first, second});
            }
        }
    }

    const optics::Barrel black(lens);
    const optics::StrayMirrors<double> mirrors;
    const auto numbers = [&] { return centre.number(); };
    double by_chance = 0.0;
    double straight = 0.0;
    int landed = 0;
    for (int i = 0; i < 200'000; ++i) {
        optics::StrayLight light{.ray = centre.ray()};
        const double projected = std::pow(light.ray.direction.z, 4);
        optics::StrayWalk walk(at, black, mirrors, numbers);
        if (walk.follow(light, false, [](const optics::StrayLight&) {}) == optics::StrayEnd::front) {
            straight += light.reflections == 0 ? projected * light.weight : 0.0;
            const bool is_ghost = light.reflections == 2 && is_beside(light.ray.direction);
            by_chance += is_ghost ? projected * light.weight : 0.0;
            landed += is_ghost ? 1 : 0;
        }
    }
    const double fraction = by_chance / straight;
    EXPECT_NEAR(fraction, pairs / image, (4.0 / std::sqrt(landed) + 0.02) * fraction);  // 3000 rays know 2 % of pairs
    const VeilingGlare glare =
        veiling_glare(lens, {.wavelength_nm = kWavelength, .spot_angle = spot, .paths = 200'000, .threads = 1});
    EXPECT_GT(glare.ghosts.fraction, fraction / (1.0 + 2.0 * fraction));
    EXPECT_LT(glare.ghosts.fraction, 2.0 * fraction);
    EXPECT_EQ(glare.blur.fraction, 0.0);
}

// Walls add light, and leave the ghosts as they are; a sensor that is a mirror adds ghosts. Nothing depends on threads.
TEST(VeilingGlare, WallsAndSensorAddTheirs) {
    optics::Lens lens = formats::load_lens("tessar");
    VeilingGlareSettings settings{
        .wavelength_nm = kWavelength, .spot_angle = tenth_of_field(lens, kWavelength), .paths = 120'000, .threads = 1};
    const VeilingGlare black = veiling_glare(lens, settings);
    lens.barrel.tube = lens.barrel.edges = lens.barrel.blades = {.albedo = 0.2};
    const VeilingGlare grey = veiling_glare(lens, settings);
    settings.threads = 2;
    EXPECT_EQ(veiling_glare(lens, settings).index.fraction, grey.index.fraction);
    lens.barrel.tube.albedo = lens.barrel.edges.albedo = lens.barrel.blades.albedo = 0.4;
    settings.mirrors.sensor = 1.0;
    const VeilingGlare bright = veiling_glare(lens, settings);
    EXPECT_EQ(black.barrel.fraction, 0.0);
    EXPECT_GT(grey.barrel.fraction, 10.0 * grey.barrel.standard_error);
    EXPECT_GT(bright.barrel.fraction, 1.5 * grey.barrel.fraction);
    settings.polarised = true;
    settings.mirrors.sensor = 0.0;
    lens.barrel.tube.albedo = lens.barrel.edges.albedo = lens.barrel.blades.albedo = 0.2;
    const VeilingGlare polarised = veiling_glare(lens, settings);  // on the same paths
    EXPECT_EQ(polarised.index.fraction, grey.index.fraction);
    EXPECT_EQ(polarised.barrel.fraction, grey.barrel.fraction);
    EXPECT_NEAR(polarised.polarised->barrel.fraction, grey.barrel.fraction, 0.2 * grey.barrel.fraction);
    EXPECT_NEAR(grey.ghosts.fraction, black.ghosts.fraction,
                4.0 * std::hypot(grey.ghosts.standard_error, black.ghosts.standard_error));
    EXPECT_GT(bright.ghosts.fraction,
              black.ghosts.fraction + 3.0 * std::hypot(bright.ghosts.standard_error, black.ghosts.standard_error));
}

TEST(VeilingGlare, NeedsAFocalLength) {
    optics::Prescription prescription;
    prescription.surfaces = {{.thickness_mm = 9.0, .semi_diameter_mm = 1.0, .is_stop = true}};
    EXPECT_THROW(tenth_of_field(optics::make_lens(prescription, {}), kWavelength), InputError);
}

}  // namespace lensproof::analysis::veiling_glare_test
