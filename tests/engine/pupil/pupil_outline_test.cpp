// Outlines found by asking which points lie inside, and the columns that hold them, against shapes of known area.
#include "engine/pupil/pupil_outline.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "engine/base/angle.h"
#include "engine/pupil/column_fit.h"

namespace lensproof::pupil::pupil_outline_test {

struct Shape {
    std::string name;
    std::function<bool(Vec2d)> holds;
    double area;
    Vec2d inside;  // for what is thinner than a grid
    PupilSymmetry symmetry = PupilSymmetry::mirror;
    double excess = 0.007;  // the fraction by which its region may be larger
};

bool in_disc(Vec2d p, Vec2d centre, double radius) {
    return std::hypot(p.x - centre.x, p.y - centre.y) <= radius;
}

/// Of the intersection of two discs of radius `a`, `b` at a distance.
double lens_area(double a, double b, double distance) {
    const double to_chord = (distance * distance + a * a - b * b) / (2.0 * distance);
    const auto segment = [](double radius, double from_centre) {
        const double fraction = from_centre / radius;
        return radius * radius * (std::acos(fraction) - fraction * std::sqrt(1.0 - fraction * fraction));
    };
    return segment(a, to_chord) + segment(b, distance - to_chord);
}

/// A disc off the axis; a cat's eye; a sliver 1/90 as thick as wide; a crescent's straightened twin, a strip bent by
/// twenty times its thickness, whose shear keeps the area of its ellipse; an ellipse that no symmetry helps.
std::vector<Shape> shapes() {
    return {{"disc",
             [](Vec2d p) {
                 return in_disc(p, {0.0, 1.0}, 2.0);
             },
             4.0 * kPi,
             {0.0, 1.0}},
            {"cat's eye",
             [](Vec2d p) {
                 return in_disc(p, {0.0, 0.0}, 3.0) && in_disc(p, {0.0, 4.0}, 3.5);
             },
             lens_area(3.0, 3.5, 4.0),
             {0.0, 2.0}},
            {"sliver",
             [](Vec2d p) {
                 return in_disc(p, {0.0, 0.0}, 3.0) && in_disc(p, {0.0, 6.99}, 4.0);
             },
             lens_area(3.0, 4.0, 6.99),
             {0.0, 2.993}},
            {"strip",
             [](Vec2d p) { return std::hypot(p.x / 3.0, (p.y + 0.11 * p.x * p.x) / 0.05) <= 1.0; },
             0.15 * kPi,
             {0.0, 0.01},
             PupilSymmetry::mirror,
             0.025},
            {"ellipse",
             [](Vec2d p) { return std::hypot((p.x - 1.0 + 0.2 * p.y) / 0.8, (p.y + 1.0) / 1.7) <= 1.0; },
             0.8 * 1.7 * kPi,
             {1.0, -1.0},
             PupilSymmetry::none}};
}

PupilOutline outline_of(const Shape& shape) {
    const PassTest passes = [&](std::span<const RegionPoint> points, std::span<std::uint8_t> answers) {
        for (std::size_t i = 0; i < points.size(); ++i) {
            answers[i] = shape.holds(points[i].point) ? 1 : 0;
        }
    };
    const std::vector<std::optional<PupilFrame>> unknown(1);
    return pupil_outlines(
               passes, unknown,
               {.radius = 5.0,
                .symmetry = shape.symmetry,
                .look_closer =
                    [&](int) { return shape.holds(shape.inside) ? std::optional(shape.inside) : std::nullopt; }})
        .front();
}

PupilRegion region_of(const Shape& shape) {
    const PupilOutline outline = outline_of(shape);
    if (outline.is_empty()) {
        return {};
    }
    Extent extent = extent_of({&outline, 1});
    extent.left = shape.symmetry == PupilSymmetry::mirror ? 0.0 : extent.left;
    return region_around({&outline, 1}, extent, shape.symmetry);
}

// The polygon's own excess over a smooth outline of n points is (2π / n)² / 3, 0.15 % of 96 and 0.3 % of 64; edge
// points add 2e-4, corners 5e-5 each, columns (π / 48)² / 3 = 0.15 %, which a sliver's pointed ends double. The strip,
// 0.1 thick, bends by 0.11 (3 π / 48)² / 4 = 0.001 off the straight line between two columns, on either side: 2 %. No
// region can be smaller than the shape that it holds.
TEST(PupilOutline, RegionsAreHardlyLargerThanTheirShapes) {
    for (const Shape& shape : shapes()) {
        const PupilRegion region = region_of(shape);
        const double area = BlendedRegion<1>({&region}, {1.0}, shape.symmetry).area();
        EXPECT_GT(area, shape.area) << shape.name;
        EXPECT_LT(area, (1.0 + shape.excess) * shape.area) << shape.name;
    }
}

// No point of a shape lies outside its region. Points are drawn over the region's surroundings, a quarter larger.
TEST(PupilOutline, RegionsHoldTheirShapes) {
    for (const Shape& shape : shapes()) {
        const PupilRegion region = region_of(shape);
        const BlendedRegion<1> held({&region}, {1.0}, shape.symmetry);
        double lower = region.columns[0].lower;
        double upper = region.columns[0].upper;
        for (const PupilColumn& column : region.columns) {
            lower = std::min(lower, column.lower);
            upper = std::max(upper, column.upper);
        }
        std::mt19937_64 random(3);
        std::uniform_real_distribution<double> uniform(-0.125, 1.125);
        int inside = 0;
        for (int i = 0; i < 200000; ++i) {
            const Vec2d at{std::lerp(region.left, region.left + region.width, uniform(random)),
                           std::lerp(lower, upper, uniform(random))};
            if (shape.holds(at)) {
                ++inside;
                EXPECT_TRUE(held.contains(at)) << shape.name << " misses (" << at.x << ", " << at.y << ")";
            }
        }
        EXPECT_GT(inside, 5000) << shape.name;
    }
}

// Where nothing is inside, nothing is found; where the grid meets nothing, the closer look's point is enough.
TEST(PupilOutline, FindsWhatIsThere) {
    EXPECT_TRUE(outline_of({"nothing", [](Vec2d) { return false; }, 0.0, {}}).is_empty());
    const PupilOutline speck = outline_of({"speck",
                                           [](Vec2d p) {
                                               return in_disc(p, {0.0, 1.2345}, 1e-3);
                                           },
                                           1e-6 * kPi,
                                           {0.0, 1.2343}});
    ASSERT_FALSE(speck.is_empty());
    EXPECT_NEAR(extent_of({&speck, 1}).right, 1e-3, 2e-6);
}

// A cat's eye that the grid misses, from a point at its very edge: the frame settles in its middle, so that rays from
// there see its corners as well as those of one that is met.
TEST(PupilOutline, FramesAreCentred) {
    const Shape eye{"small cat's eye",
                    [](Vec2d p) {
                        return in_disc(p, {0.0, 1.23}, 0.03) && in_disc(p, {0.0, 1.27}, 0.035);
                    },
                    1e-4 * lens_area(3.0, 3.5, 4.0),
                    {0.0, 1.2599}};
    const PupilOutline outline = outline_of(eye);
    ASSERT_FALSE(outline.is_empty());
    EXPECT_NEAR(outline.frame.centre.y, 0.5 * (1.235 + 1.26), 1e-5);
    const PupilRegion region = region_of(eye);
    EXPECT_LT(BlendedRegion<1>({&region}, {1.0}, eye.symmetry).area(), 1.007 * eye.area);
}

}  // namespace lensproof::pupil::pupil_outline_test
