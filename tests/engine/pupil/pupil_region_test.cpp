// Regions in columns: their areas, and the points drawn from them.
#include "engine/pupil/pupil_region.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

namespace lensproof::pupil::pupil_region_test {

/// A region of the given width with the chains y = lower(x), y = upper(x).
template <class Lower, class Upper>
PupilRegion region_of(PupilSymmetry symmetry, double left, double width, const Lower& lower, const Upper& upper) {
    PupilRegion region{.left = left, .width = width};
    const PupilFractions& fractions = pupil_fractions(symmetry);
    for (std::size_t i = 0; i < region.columns.size(); ++i) {
        const double x = left + width * fractions.at[i];
        region.columns[i] = {.lower = lower(x), .upper = upper(x)};
    }
    region.sum_areas(symmetry);
    return region;
}

struct Case {
    std::string name;
    PupilSymmetry symmetry;
    PupilRegion region;
};

/// A disc, a sliver between two arcs that is bent ten times as much as it is thick, a triangle with a point at its
/// left, and a disc that a chord cuts off, at x ≥ 0.
std::vector<Case> cases() {
    const auto circle = [](double x) { return std::sqrt(std::max(0.0, 1.0 - x * x)); };
    const auto whole = PupilSymmetry::none;
    const auto half = PupilSymmetry::mirror;
    return {
        {"disc", half,
         region_of(
             half, 0.0, 1.0, [&](double x) { return 3.0 - circle(x); }, [&](double x) { return 3.0 + circle(x); })},
        {"sliver", half,
         region_of(
             half, 0.0, 2.0, [](double x) { return 0.05 * x * x; }, [](double x) { return 0.02 + 0.045 * x * x; })},
        {"triangle", whole,
         region_of(
             whole, -1.0, 3.0, [](double x) { return -0.1 * (x + 1.0); }, [](double x) { return 0.7 * (x + 1.0); })},
        {"cut disc", whole,
         region_of(
             whole, -1.0, 2.0, [](double) { return 0.0; }, circle)}};
}

BlendedRegion<1> alone(const Case& c) {
    return {{&c.region}, {1.0}, c.symmetry};
}

/// The region's polygon, both halves of a mirror image, by rising azimuth.
std::vector<Vec2d> polygon(const Case& c) {
    std::vector<Vec2d> points;
    const PupilFractions& fractions = pupil_fractions(c.symmetry);
    const auto x = [&](int i) { return c.region.left + c.region.width * fractions.at[i]; };
    for (int i = 0; i <= kPupilPanels; ++i) {
        points.push_back({x(i), c.region.columns[i].lower});
    }
    for (int i = kPupilPanels; i >= 0; --i) {
        points.push_back({x(i), c.region.columns[i].upper});
    }
    if (c.symmetry == PupilSymmetry::mirror) {
        for (int i = static_cast<int>(points.size()) - 1; i >= 0; --i) {
            points.push_back({-points[i].x, points[i].y});
        }
    }
    return points;
}

/// Area, centroid and second moments of a polygon by Green's theorem.
struct Moments {
    double area = 0.0;
    double x = 0.0;
    double y = 0.0;
    double xx = 0.0;
    double yy = 0.0;
};

Moments moments(const std::vector<Vec2d>& points) {
    Moments m;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const Vec2d p = points[i];
        const Vec2d q = points[(i + 1) % points.size()];
        const double cross = p.x * q.y - p.y * q.x;
        m.area += cross / 2.0;
        m.x += cross * (p.x + q.x) / 6.0;
        m.y += cross * (p.y + q.y) / 6.0;
        m.xx += cross * (p.x * p.x + p.x * q.x + q.x * q.x) / 12.0;
        m.yy += cross * (p.y * p.y + p.y * q.y + q.y * q.y) / 12.0;
    }
    return {m.area, m.x / m.area, m.y / m.area, m.xx / m.area, m.yy / m.area};
}

// The area is the polygon's; the mean of points and of their squares over the unit square, on a grid of midpoints of
// step h, are the polygon's to h² times a few sizes of the region: 1e-4 of them with h = 1/256.
TEST(PupilRegion, DrawsEvenly) {
    constexpr int kGrid = 256;
    for (const Case& c : cases()) {
        const Moments expected = moments(polygon(c));
        const BlendedRegion<1> region = alone(c);
        const PanelGuide guide = panel_guide(c.region);
        EXPECT_NEAR(region.area() / expected.area, 1.0, 1e-13) << c.name;
        Moments drawn;
        for (int i = 0; i < kGrid; ++i) {
            for (int k = 0; k < kGrid; ++k) {
                const Vec2d at = region.sample((i + 0.5) / kGrid, (k + 0.5) / kGrid, guide);
                constexpr double kFraction = 1.0 / kGrid / kGrid;
                drawn = {0.0, drawn.x + kFraction * at.x, drawn.y + kFraction * at.y,
                         drawn.xx + kFraction * at.x * at.x, drawn.yy + kFraction * at.y * at.y};
            }
        }
        EXPECT_NEAR(drawn.x, expected.x, 1e-4 * c.region.width) << c.name;
        EXPECT_NEAR(drawn.y, expected.y, 1e-4) << c.name;
        EXPECT_NEAR(drawn.xx, expected.xx, 1e-4 * c.region.width * c.region.width) << c.name;
        EXPECT_NEAR(drawn.yy, expected.yy, 1e-3 * std::max(0.1, expected.yy)) << c.name;
    }
}

// Pearson's χ² of random points in the cells that 24 columns of equal width and four equal parts of each panel's height
// make: a cell's fraction is that of its area, here by midpoints of 1000 lines across each. A right sampler exceeds its
// mean, the number of cells less one, by five standard deviations once in three million times; seeds are fixed.
TEST(PupilRegion, PointsFollowTheArea) {
    constexpr int kColumns = 24;
    constexpr int kParts = 4;
    constexpr int kCells = kColumns * kParts;
    constexpr int kPoints = 200000;
    for (const Case& c : cases()) {
        const BlendedRegion<1> region = alone(c);
        const bool is_mirror = c.symmetry == PupilSymmetry::mirror;
        const double left = is_mirror ? -c.region.width : c.region.left;
        const double width = is_mirror ? 2.0 * c.region.width : c.region.width;
        const std::vector<Vec2d> outline = polygon(c);
        const auto heights = [&](double x) {
            const PupilFractions& fractions = pupil_fractions(c.symmetry);
            const double fraction = ((is_mirror ? std::abs(x) : x) - c.region.left) / c.region.width;
            const int i = fractions.panel(fraction);
            const double t = (fraction - fractions.at[i]) / (fractions.at[i + 1] - fractions.at[i]);
            const PupilColumn& a = c.region.columns[i];
            const PupilColumn& b = c.region.columns[i + 1];
            return std::pair{std::lerp(a.lower, b.lower, t), std::lerp(a.upper, b.upper, t)};
        };
        std::vector<double> fraction(kColumns, 0.0);
        double sum = 0.0;
        for (int i = 0; i < 1000 * kColumns; ++i) {
            const auto [lower, upper] = heights(left + width * (i + 0.5) / (1000 * kColumns));
            fraction[i / 1000] += upper - lower;
            sum += upper - lower;
        }
        std::vector<int> count(kCells, 0);
        std::mt19937_64 random(7);
        std::uniform_real_distribution<double> uniform(0.0, 1.0);
        const PanelGuide guide = panel_guide(c.region);
        for (int i = 0; i < kPoints; ++i) {
            const double u = uniform(random);
            const Vec2d at = region.sample(u, uniform(random), guide);
            const auto [lower, upper] = heights(at.x);
            const int column = std::clamp(static_cast<int>((at.x - left) / width * kColumns), 0, kColumns - 1);
            const int part = std::clamp(static_cast<int>((at.y - lower) / (upper - lower) * kParts), 0, kParts - 1);
            ++count[column * kParts + part];
        }
        double chi2 = 0.0;
        for (int i = 0; i < kCells; ++i) {
            const double expected = kPoints * fraction[i / kParts] / sum / kParts;
            chi2 += std::pow(count[i] - expected, 2) / expected;
        }
        constexpr double kDegrees = kCells - 1;
        EXPECT_LT(chi2, kDegrees + 5.0 * std::sqrt(2.0 * kDegrees)) << c.name;
        EXPECT_GT(chi2, kDegrees - 5.0 * std::sqrt(2.0 * kDegrees)) << c.name;
    }
}

// What is drawn is held, and what is not held is never drawn: points that the unit square's inside maps to lie in the
// region, any guide gives the same, and points beside its polygon do not.
TEST(PupilRegion, HoldsWhatItDraws) {
    const PanelGuide other = panel_guide(cases()[2].region);
    for (const Case& c : cases()) {
        const BlendedRegion<1> region = alone(c);
        const PanelGuide guide = panel_guide(c.region);
        std::mt19937_64 random(11);
        std::uniform_real_distribution<double> uniform(0.0, 1.0);
        for (int i = 0; i < 10000; ++i) {
            const double u = uniform(random);
            const double v = 0.001 + 0.998 * uniform(random);  // not by rounding alone beyond an edge
            const Vec2d at = region.sample(u, v, guide);
            EXPECT_TRUE(region.contains(at)) << c.name;
            EXPECT_EQ(region.sample(u, v, other), at) << c.name;
            EXPECT_FALSE(region.contains({at.x, at.y + 5.0})) << c.name;
        }
    }
}

// A blend's columns are the means of its regions' columns: its area, and that of a region made of those means, agree.
TEST(PupilRegion, BlendsAreRegions) {
    const std::vector<Case> all = cases();
    const Case& disc = all[0];
    const Case& sliver = all[1];
    Case mean = disc;
    mean.region.width = 0.3 * disc.region.width + 0.7 * sliver.region.width;
    for (std::size_t i = 0; i < mean.region.columns.size(); ++i) {
        mean.region.columns[i].lower = 0.3 * disc.region.columns[i].lower + 0.7 * sliver.region.columns[i].lower;
        mean.region.columns[i].upper = 0.3 * disc.region.columns[i].upper + 0.7 * sliver.region.columns[i].upper;
    }
    mean.region.sum_areas(PupilSymmetry::mirror);
    const BlendedRegion<2> blend({&disc.region, &sliver.region}, {0.3, 0.7}, PupilSymmetry::mirror);
    EXPECT_NEAR(blend.area() / moments(polygon(mean)).area, 1.0, 1e-13);
    const PanelGuide guide = panel_guide(mean.region);
    for (int i = 0; i < 1000; ++i) {
        const double u = (i + 0.5) / 1000;
        const Vec2d a = blend.sample(u, 0.3, guide);
        const Vec2d b = alone(mean).sample(u, 0.3, guide);
        EXPECT_NEAR(a.x, b.x, 1e-12);
        EXPECT_NEAR(a.y, b.y, 1e-12);
    }
}

// A mirror image's two halves are each other's images: u and 1 − u map to x and −x.
TEST(PupilRegion, MirrorImagesAreEven) {
    const Case disc = cases()[0];
    const PanelGuide guide = panel_guide(disc.region);
    for (const double u : {0.51, 0.625, 0.75, 0.99}) {
        const Vec2d right = alone(disc).sample(u, 0.25, guide);
        const Vec2d left = alone(disc).sample(1.0 - u, 0.25, guide);
        EXPECT_GT(right.x, 0.0);
        EXPECT_NEAR(left.x, -right.x, 1e-12);
        EXPECT_NEAR(left.y, right.y, 1e-12);
    }
}

// A region without area, where the light ends, has points all the same, all finite, on itself.
TEST(PupilRegion, NoAreaIsNoTrouble) {
    const PupilRegion line = region_of(
        PupilSymmetry::none, -1.0, 2.0, [](double x) { return x; }, [](double x) { return x; });
    const PupilRegion point{.left = 1.0, .width = 0.0};
    for (const PupilRegion& region : {line, point}) {
        const BlendedRegion<1> alone({&region}, {1.0}, PupilSymmetry::none);
        EXPECT_EQ(alone.area(), 0.0);
        const Vec2d at = alone.sample(0.3, 0.9, panel_guide(region));
        EXPECT_TRUE(std::isfinite(at.x) && std::isfinite(at.y));
        EXPECT_LE(std::abs(at.x), 1.0);
        EXPECT_FALSE(alone.contains({5.0, 5.0}));
    }
}

}  // namespace lensproof::pupil::pupil_region_test
