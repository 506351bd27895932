#include "engine/polynomial/polynomial_lens.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "engine/base/input_error.h"
#include "engine/formats/prescription/load_lens.h"
#include "engine/optics/focus.h"
#include "engine/optics/packet/spectral_lens.h"
#include "engine/polynomial/polynomial_fit.h"
#include "engine/pupil/kept_maps.h"
#include "tests/complaint.h"
#include "tests/test_folder.h"

namespace lensproof::polynomial::polynomial_lens_test {
namespace {

const std::vector<double> kWavelengths{400.0, 450.0, 500.0, 550.0, 600.0, 650.0, 700.0};

/// A lens with all that a fit of it takes.
struct Fitted {
    optics::Lens lens;
    double film_radius_mm;
    optics::SpectralLens<double> at = optics::at_wavelengths<double>(lens, kWavelengths);
    pupil::PupilMap pupil{at.at(), true, film_radius_mm};
    PolynomialLens polynomial;

    Fitted(optics::Lens of, double radius_mm, const FitSettings& settings = {})
        : lens(std::move(of)),
          film_radius_mm(radius_mm),
          polynomial(fit_polynomial(lens, kWavelengths, pupil, radius_mm, settings)) {}
};

const Fitted& double_gauss() {
    static const Fitted fitted(
        optics::focused_at(optics::with_f_number(formats::load_lens("double-gauss-tronnier"), 2.0), 5000.0), 21.6);
    return fitted;
}

const Fitted& fisheye() {
    static const Fitted fitted(
        optics::focused_at(optics::with_f_number(formats::load_lens("muller-fisheye"), 4.0), 50000.0), 12.75);
    return fitted;
}

/// Points of film and pupil inside the map's regions.
struct Through {
    Vec2d film;
    Vec2d pupil;
    int wavelength;
};

std::vector<Through> points(const Fitted& of, int count) {
    std::vector<Through> found;
    for (int i = 0; i < count; ++i) {
        const double radius = of.film_radius_mm * std::sqrt((i + 0.5) / count);
        const Vec2d film{radius * std::cos(2.4 * i), radius * std::sin(2.4 * i)};
        const int wavelength = i % static_cast<int>(kWavelengths.size());
        const double band = wavelength / (static_cast<double>(kWavelengths.size()) - 1.0);
        const double u = std::fmod(0.618034 * i, 1.0);
        const pupil::PupilSample drawn = of.pupil.sample(film, band, 0.01 + 0.99 * u, std::fmod(0.7548777 * i, 1.0));
        if (drawn.pdf > 0.0) {
            found.push_back({film, drawn.point, wavelength});
        }
    }
    return found;
}

/// A stop and nothing else.
optics::Lens empty_lens() {
    optics::Prescription prescription;
    prescription.name = "empty";
    prescription.surfaces = {{.thickness_mm = 50.0, .semi_diameter_mm = 4.0, .is_stop = true}};
    return optics::make_lens(prescription, optics::GlassCatalogue{});
}

// Rays through a hole are straight lines. tan(θ/2) is no polynomial, but at θ < 0.2 terms fall by a hundred each, so
// that the fit comes to the rounding of millimetres and of its least squares.
TEST(PolynomialLens, OfAHoleIsStraight) {
    const Fitted hole(
        empty_lens(), 6.0,
        {.wanted_um = 1e-7, .wanted_entry = 1e-10, .fitted_rays = 1500, .held_out_rays = 500, .judging_rays = 1000});
    EXPECT_LT(hole.polynomial.error().rms_um, 1e-6);
    for (const Through& at : points(hole, 50)) {
        const PolynomialExit out = hole.polynomial.exit(at.film, at.pupil, at.wavelength);
        const Vec3d film{at.film.x, at.film.y, 50.0};
        const Vec3d straight = normalized(Vec3d{at.pupil.x, at.pupil.y, hole.pupil.plane_z()} - film);
        EXPECT_NEAR(length(out.ray.direction - straight), 0.0, 1e-10);
        EXPECT_NEAR(length(cross(out.ray.origin - film, straight)), 0.0, 1e-8);
        EXPECT_TRUE(out.transmittance == 0.0 || std::abs(out.transmittance - 1.0) < 1e-12);
    }
}

/// That rays which no fit has seen land within what is stated: 20 000, of which 20 may exceed the bound.
void expect_to_keep(const Fitted& of, double most_um) {
    const PolynomialError& stated = of.polynomial.error();
    EXPECT_LT(stated.rms_um, most_um);
    const PolynomialError fresh = measured_error(of.polynomial, of.at.at(), of.pupil, 40'000'000, 20'000);
    EXPECT_NEAR(fresh.rms_um, stated.rms_um, 0.1 * stated.rms_um);
    EXPECT_LT(fresh.bound_um, 1.25 * stated.bound_um);  // both with a quarter to spare
    EXPECT_LT(std::abs(fresh.irradiance), 0.002);
    EXPECT_LT(std::abs(fresh.worst_irradiance), 0.008);
}

TEST(PolynomialLens, OfTheDoubleGaussKeepsItsError) {
    expect_to_keep(double_gauss(), 2.0);
}

TEST(PolynomialLens, OfTheFisheyeKeepsItsError) {
    expect_to_keep(fisheye(), 5.0);
}

// Newton's last step is below 1e-10 of the film, and converges quadratically: what is left is rounding.
TEST(PolynomialLens, ComesBackToWhereItBegan) {
    for (const Fitted* of : {&double_gauss(), &fisheye()}) {
        int seen = 0;
        for (const Through& at : points(*of, 2000)) {
            const PolynomialExit out = of->polynomial.exit(at.film, at.pupil, at.wavelength);
            if (!(out.transmittance > 0.0)) {
                continue;
            }
            // From a metre off, as light comes.
            const Vec3d far = out.ray.origin + 1000.0 * out.ray.direction;
            const auto back = of->polynomial.end({far, -1.0 * out.ray.direction}, at.wavelength);
            ASSERT_TRUE(back) << of->lens.name << " " << length(at.film);
            EXPECT_NEAR(length(back->film - at.film), 0.0, 1e-9);
            EXPECT_NEAR(length(back->pupil - at.pupil), 0.0, 1e-9);
            EXPECT_NEAR(back->transmittance, out.transmittance, 1e-9);
            ++seen;
        }
        EXPECT_GT(seen, 1800);
    }
}

// A lens keeps etendue, and a polynomial of it does as well as it follows the lens: on the mean over the beam to a
// part in a thousand, ray by ray to what the slopes of its error are.
TEST(PolynomialLens, KeepsEtendueAsTheLensDoes) {
    for (const Fitted* of : {&double_gauss(), &fisheye()}) {
        double sum = 0.0;
        double squares = 0.0;
        int seen = 0;
        for (const Through& at : points(*of, 2000)) {
            const PolynomialExit out = of->polynomial.exit(at.film, at.pupil, at.wavelength);
            const auto back = of->polynomial.end({out.ray.origin, -1.0 * out.ray.direction}, at.wavelength);
            if (back) {
                sum += back->etendue - 1.0;
                squares += (back->etendue - 1.0) * (back->etendue - 1.0);
                ++seen;
            }
        }
        EXPECT_LT(std::abs(sum / seen), 0.002);
        EXPECT_LT(std::sqrt(squares / seen), 0.02);
    }
}

TEST(PolynomialLens, RaysFromElsewhereDoNotArrive) {
    const PolynomialLens& lens = double_gauss().polynomial;
    EXPECT_FALSE(lens.end({{0.0, 0.0, -100.0}, normalized(Vec3d{0.0, 1.0, 1.0})}, 3));    // passes the front by
    EXPECT_FALSE(lens.end({{0.0, -80.0, -100.0}, normalized(Vec3d{0.0, 0.8, 1.0})}, 3));  // from beside the film
    EXPECT_FALSE(lens.end({{0.0, 17.9, -100.0}, {0.0, 0.0, 1.0}}, 3));                    // the stop cuts it
}

// All levels make the same bits, which are those of one ray by itself but for the order of sums: some 40 terms of size
// 1 and less.
TEST(PolynomialLens, PacketsAreTheRaysThemselves) {
    const PolynomialLens& lens = fisheye().polynomial;
    const std::vector<Through> from = points(fisheye(), 61);
    constexpr std::size_t kColumn = 64;
    std::vector<optics::PacketColumn<double>> columns(4, optics::PacketColumn<double>(kColumn));
    optics::PacketColumn<std::uint16_t> wavelengths(kColumn);
    for (std::size_t i = 0; i < from.size(); ++i) {
        columns[0][i] = from[i].film.x;
        columns[1][i] = from[i].film.y;
        columns[2][i] = from[i].pupil.x;
        columns[3][i] = from[i].pupil.y;
        wavelengths[i] = static_cast<std::uint16_t>(from[i].wavelength);
    }
    const FilmRays rays{columns[0].data(), columns[1].data(),  columns[2].data(),
                        columns[3].data(), wavelengths.data(), static_cast<int>(from.size())};
    optics::RayBatch<double> first(kColumn);
    polynomial_kernels(SimdLevel::scalar).find_exits(lens.tables(), rays, first);
    for (const SimdLevel level : available_simd_levels()) {
        optics::RayBatch<double> found(kColumn);
        polynomial_kernels(level).find_exits(lens.tables(), rays, found);
        for (std::size_t i = 0; i < from.size(); ++i) {
            const int at = static_cast<int>(i);
            EXPECT_EQ(found.ray(at).origin, first.ray(at).origin) << simd_name(level);
            EXPECT_EQ(found.ray(at).direction, first.ray(at).direction) << simd_name(level);
            EXPECT_EQ(found.transmittance[i], first.transmittance[i]) << simd_name(level);
        }
    }
    for (std::size_t i = 0; i < from.size(); ++i) {
        const PolynomialExit one = lens.exit(from[i].film, from[i].pupil, from[i].wavelength);
        EXPECT_NEAR(length(first.ray(static_cast<int>(i)).origin - one.ray.origin), 0.0, 1e-11);
        EXPECT_NEAR(length(first.ray(static_cast<int>(i)).direction - one.ray.direction), 0.0, 1e-13);
        EXPECT_NEAR(first.transmittance[i], one.transmittance, 1e-13);
    }
}

TEST(PolynomialLens, IsTheSameFromTheCache) {
    const Fitted& of = double_gauss();
    const TestFolder folder;
    const Cache cache(folder.path());
    const FitSettings quick{.wanted_um = 20.0, .fitted_rays = 800, .held_out_rays = 200, .judging_rays = 500};
    const auto kept_bytes = [&](const Cache& in, const FitSettings& settings) {
        return kept_polynomial(in, of.lens, kWavelengths, of.pupil, of.film_radius_mm, settings).serialized();
    };
    const std::string bytes = kept_bytes(Cache(), quick);
    EXPECT_EQ(kept_bytes(cache, quick), bytes);
    EXPECT_EQ(kept_bytes(cache, quick), bytes);
    FitSettings finer = quick;
    finer.wanted_um = 10.0;
    EXPECT_NE(kept_bytes(cache, finer), bytes);
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 2);
    const auto back = PolynomialLens::deserialized(bytes);
    ASSERT_TRUE(back);
    EXPECT_EQ(back->serialized(), bytes);
    EXPECT_FALSE(PolynomialLens::deserialized(std::string_view(bytes).substr(0, bytes.size() - 1)));
    EXPECT_FALSE(PolynomialLens::deserialized(bytes + "x"));
}

TEST(PolynomialLens, RefusesLensesThatAreNotRound) {
    const Fitted& of = double_gauss();
    const auto fit = [&](const optics::Lens& lens) {
        return complaint_about([&] { fit_polynomial(lens, kWavelengths, of.pupil, of.film_radius_mm); });
    };
    optics::Lens tilted = of.lens;
    tilted.is_rotationally_symmetric = false;
    EXPECT_TRUE(says(fit(tilted), "tilted"));
    optics::Lens bladed = of.lens;
    bladed.stop_mask = optics::StopMask(optics::PolygonStop{.blades = 6});
    EXPECT_TRUE(says(fit(bladed), "blades"));
    optics::Lens mirrored = of.lens;
    mirrored.surfaces[0].is_mirror = true;
    EXPECT_TRUE(says(fit(mirrored), "mirrors"));
}

}  // namespace
}  // namespace lensproof::polynomial::polynomial_lens_test
