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

/// Whether `pdf(point)` is as expected, or would be a nanometre beside it: at a border rounding decides.
template <class Pdf>
bool is_pdf(const Pdf& pdf, Vec2d point, double expected) {
    constexpr double kBesideMm = 1e-6;
    for (const Vec2d& beside : {Vec2d{}, {kBesideMm, 0.0}, {-kBesideMm, 0.0}, {0.0, kBesideMm}, {0.0, -kBesideMm}}) {
        if (std::abs(pdf(point + beside) - expected) <= 1e-11 * expected) {
            return true;
        }
    }
    return false;
}

// Points on the disc and around it, and on the regions' borders, where v is 0 or 1. Where a place stands between two
// radii has the rounding of its fraction of the end, 2e-16, over a step of some 1e-3: 1e-12 of a region's area, and a
// few times that where areas fall fast.
TEST(PupilSlices, WeighPointsAsTheMapDoes) {
    for (const auto& [name, half_diagonal_mm] : {std::pair{"tessar", 60.0}, {"muller-fisheye", 16.0}}) {
        const SlicedLens lens(name, half_diagonal_mm);
        const double reach_mm = 1.1 * lens.map.disc().radius;
        int inside = 0;
        int at_border = 0;
        int in_defence = 0;
        int outside = 0;
        for (const Sample& s : samples(20000, kSlices, half_diagonal_mm)) {
            const double position = s.slice / (kSlices - 1.0);
            const auto expect_the_same = [&](Vec2d point) {
                const double weighed = lens.slices.pdf(s.film, s.slice, point);
                const auto by_map = [&](Vec2d at) { return lens.map.pdf(s.film, position, at); };
                EXPECT_TRUE(is_pdf(by_map, point, weighed))
                    << weighed << " and " << by_map(point) << " at " << point.x << ", " << point.y;
                return weighed;
            };
            const double pdf = expect_the_same({reach_mm * (2.0 * s.u - 1.0), reach_mm * (2.0 * s.v - 1.0)});
            const double region_mm2 = lens.map.region_area(s.film, position);
            const bool is_inside = region_mm2 > 0.0 && pdf > 0.99 / region_mm2;
            inside += is_inside ? 1 : 0;
            in_defence += !is_inside && pdf > 0.0 ? 1 : 0;
            outside += pdf == 0.0 ? 1 : 0;
            const PupilDraw<double> on_border = lens.slices.sample(s.film, s.slice, s.u, s.slice % 2);
            if (on_border.area > 0.0) {
                ++at_border;
                expect_the_same(on_border.point);
            }
        }
        for (const int count : {inside, at_border, in_defence, outside}) {
            EXPECT_GT(count, 500) << name;
        }
    }
}

// The pdf of a point is that which it was drawn with.
TEST(PupilSlices, WeighWhatTheyDraw) {
    const SlicedLens lens("tessar", 60.0);
    int lit = 0;
    for (const Sample& s : samples(20000, kSlices, lens.sensor_radius_mm)) {
        const PupilDraw<double> draw = lens.slices.sample(s.film, s.slice, s.u, s.v);
        if (draw.area > 0.0) {
            ++lit;
            EXPECT_TRUE(
                is_pdf([&](Vec2d at) { return lens.slices.pdf(s.film, s.slice, at); }, draw.point, 1.0 / draw.area));
        }
    }
    EXPECT_GT(lit, 5000);
}

// The pdf integrates to the fraction of draws that start a path: 1, or the defensive fraction where no light was found.
// A border of some 4 N of N² squares leaves each of them right to half of it: √(4 N) / N² / √12 of the square, a fifth
// of which a region fills or more: 2e-4, and five times that at most.
TEST(PupilSlices, HaveAPdfThatIntegratesToWhatTheyDraw) {
    constexpr int kSquares = 500;
    for (const auto& [name, half_diagonal_mm] : {std::pair{"tessar", 60.0}, {"muller-fisheye", 16.0}}) {
        const SlicedLens lens(name, half_diagonal_mm);
        const double reach_mm = 1.01 * lens.map.disc().radius;
        const double side_mm = 2.0 * reach_mm / kSquares;
        for (const Vec2d film : {Vec2d{}, {3.0, -2.0}, {-6.0, -5.0}, {0.0, 59.0}}) {
            int started = 0;
            const std::vector<Sample> drawn = samples(10000, 1, 1.0);
            for (const Sample& s : drawn) {
                started += lens.slices.sample(film, 2, s.u, s.v).area > 0.0 ? 1 : 0;
            }
            const double expected = started == 10000 ? 1.0 : lens.map.regions().defensive_fraction();
            EXPECT_NEAR(started / 10000.0, expected, 0.003);
            double integral = 0.0;
            for (int row = 0; row < kSquares; ++row) {
                for (int column = 0; column < kSquares; ++column) {
                    const Vec2d at{side_mm * (column + 0.5) - reach_mm, side_mm * (row + 0.5) - reach_mm};
                    integral += lens.slices.pdf(film, 2, at) * side_mm * side_mm;
                }
            }
            EXPECT_NEAR(integral, expected, 1e-3 * expected) << name << " at " << film.x << ", " << film.y;
        }
    }
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
        EXPECT_EQ(slices.pdf(s.film, s.slice, draw.point), map.pdf(s.film, 0.5 * s.slice, draw.point));
    }
}

}  // namespace lensproof::pupil::pupil_slices_test
