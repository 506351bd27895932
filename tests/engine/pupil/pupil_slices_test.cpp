#include "engine/pupil/pupil_slices.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "engine/formats/prescription/load_lens.h"
#include "engine/optics/lens.h"

namespace lensproof::pupil::pupil_slices_test {

std::vector<optics::TraceLens<double>> band_of(const std::string& name, int wavelengths) {
    const optics::Lens lens = formats::load_lens(name);
    std::vector<optics::TraceLens<double>> band;
    band.reserve(static_cast<std::size_t>(wavelengths));
    for (int i = 0; i < wavelengths; ++i) {
        band.push_back(optics::at_wavelength<double>(lens, 420.0 + 260.0 * i / (wavelengths - 1)));
    }
    return band;
}

struct Sample {
    Vec2d film;
    int slice = 0;
    double u = 0.0;
    double v = 0.0;
};

/// Samples all over the sensor.
std::vector<Sample> samples(int count, int slices, double sensor_radius_mm) {
    std::mt19937_64 random(5);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    std::vector<Sample> drawn;
    for (int i = 0; i < count; ++i) {
        const double azimuth = 6.283 * unit(random);
        const double radius = sensor_radius_mm * std::sqrt(unit(random));
        drawn.push_back({.film = {radius * std::sin(azimuth), radius * std::cos(azimuth)},
                         .slice = i % slices,
                         .u = unit(random),
                         .v = unit(random)});
    }
    return drawn;
}

constexpr int kSlices = 7;

struct SlicedLens {
    explicit SlicedLens(const std::string& name, double half_diagonal_mm)
        : sensor_radius_mm(half_diagonal_mm),
          map(band_of(name, kSlices), true, half_diagonal_mm),
          slices(map, kSlices) {}

    double sensor_radius_mm;
    PupilMap map;
    PupilSlices slices;
};

// Slices are the map at its wavelengths: they draw the same points with the same pdfs. Both are means of regions
// of some 20 mm, in another order: 1e-12 mm, but where a panel's edge falls between the two roundings, or where heights
// near 0 leave the root in the cut few digits (1e-7).
TEST(PupilSlices, DrawWhatTheMapDraws) {
    for (const auto& [name, half_diagonal_mm] : {std::pair{"tessar", 60.0}, {"muller-fisheye", 16.0}}) {
        const SlicedLens lens(name, half_diagonal_mm);
        ASSERT_NE(lens.slices.tables(), nullptr);
        int lit = 0;
        for (const Sample& s : samples(20000, kSlices, half_diagonal_mm)) {
            const PupilDraw<double> draw = lens.slices.sample(s.film, s.slice, s.u, s.v);
            const PupilSample expected = lens.map.sample(s.film, s.slice / (kSlices - 1.0), s.u, s.v);
            ASSERT_EQ(draw.area > 0.0, expected.pdf > 0.0);
            if (draw.area > 0.0) {
                ++lit;
                EXPECT_NEAR(draw.point.x, expected.point.x, 1e-6);
                EXPECT_NEAR(draw.point.y, expected.point.y, 1e-6);
                EXPECT_NEAR(draw.area * expected.pdf, 1.0, 1e-11);
            }
        }
        EXPECT_GT(lit, 5000);
    }
}

// Drawn evenly: the map from what of the unit square is not for defence scales areas by region / (1 − δ) wherever it is
// smooth. The pdf is that of the mixture, (1 − δ) / region + δ / disc, so the scale over the area stated is
// 1 + δ / (1 − δ) · region / disc, from 1 to 1.0031 for δ = 0.3 %. Differences over 1e-6 show it to 1e-4; they straddle
// a panel's edge in fewer than one of a thousand places.
TEST(PupilSlices, ScaleTheUnitSquareByTheArea) {
    const SlicedLens lens("tessar", 60.0);
    constexpr double kStep = 1e-6;
    int lit = 0;
    int uneven = 0;
    for (const Sample& s : samples(20000, kSlices, lens.sensor_radius_mm)) {
        const auto at = [&](double u, double v) { return lens.slices.sample(s.film, s.slice, u, v); };
        const double u = 0.004 + 0.995 * s.u;  // beyond the defensive fraction
        const double v = 0.999 * s.v;
        const PupilDraw<double> here = at(u, v);
        if (here.area > 0.0) {
            ++lit;
            const Vec2d right = at(u + kStep, v).point;
            const Vec2d up = at(u, v + kStep).point;
            const double scale =
                ((right.x - here.point.x) * (up.y - here.point.y) - (right.y - here.point.y) * (up.x - here.point.x)) /
                (kStep * kStep);
            const double fraction = std::abs(scale) / here.area;
            uneven += fraction < 1.0 - 1e-4 || fraction > 1.0031 + 1e-4 ? 1 : 0;
        }
    }
    EXPECT_GT(lit, 5000);
    EXPECT_LT(uneven, lit / 1000);
}

// A lens that is mapped over azimuth has no tables, and is drawn from by its map.
TEST(PupilSlices, AskTheMapWhereTheLensIsNotRound) {
    const PupilMap map(band_of("tessar", 3), false, 30.0);
    const PupilSlices slices(map, 3);
    EXPECT_EQ(slices.tables(), nullptr);
    for (const Sample& s : samples(100, 3, 30.0)) {
        const PupilDraw<double> draw = slices.sample(s.film, s.slice, s.u, s.v);
        const PupilSample expected = map.sample(s.film, 0.5 * s.slice, s.u, s.v);
        EXPECT_EQ(draw.point, expected.point);
        EXPECT_EQ(draw.area, 1.0 / expected.pdf);
    }
}

}  // namespace lensproof::pupil::pupil_slices_test
