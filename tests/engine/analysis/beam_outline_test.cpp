// Outlines of regions with known areas and moments.
#include "engine/analysis/beam_outline.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "engine/base/angle.h"
#include "engine/base/infinity.h"

namespace lensproof::analysis::beam_outline_test {

struct Disc {
    Vec2d centre;
    double radius;
};

/// What several discs have in common. `sees_margin`: false tells only inside from outside, as a missed surface does.
optics::Region common_part(std::vector<Disc> discs, bool sees_margin = true) {
    return [discs = std::move(discs), sees_margin](Vec2d at) {
        optics::RegionSample worst{.margin = -kInfinity};
        for (std::size_t i = 0; i < discs.size(); ++i) {
            const double x = at.x - discs[i].centre.x;
            const double y = at.y - discs[i].centre.y;
            const double margin = (x * x + y * y) / (discs[i].radius * discs[i].radius) - 1.0;
            if (margin > worst.margin) {
                worst = {margin, static_cast<int>(i)};
            }
        }
        if (worst.margin > 0.0 && !sees_margin) {
            worst.margin = kInfinity;
        }
        return worst;
    };
}

/// Two circles of radii r and R whose centres are d apart (Weisstein, MathWorld, "Circle-Circle Intersection", eq. 14),
/// in long double, since the terms cancel for a thin lens.
double lens_area(double narrow, double wide, double apart) {
    const long double r = narrow;
    const long double R = wide;
    const long double d = apart;
    return static_cast<double>(r * r * std::acos((d * d + r * r - R * R) / (2 * d * r)) +
                               R * R * std::acos((d * d + R * R - r * r) / (2 * d * R)) -
                               std::sqrt((-d + r + R) * (d + r - R) * (d - r + R) * (d + r + R)) / 2);
}

// Wherever the search starts, a disc has its area, to the rounding of a hundred terms.
TEST(RegionOutline, DiscSeenFromAnywhere) {
    for (const double start_y : {0.0, 1.0, 2.9}) {
        for (const bool is_mirror : {false, true}) {
            const optics::RegionOutline outline = optics::region_outline(
                common_part({{{0.0, 0.5}, 3.0}}), {.start = {0.0, start_y}, .reach = 7.0, .is_mirror = is_mirror});
            EXPECT_NEAR(outline.area / (9.0 * kPi), 1.0, 1e-13) << start_y;
            EXPECT_TRUE(outline.is_star_shaped);
        }
    }
}

// Corners are found, however thin the region, where rims clip and where surfaces are missed alike. From an axis ratio
// of 1 to one of 1 : 220. Tolerance: the outline's own, 1e-11, and some twenty ulps (4e-16) of the coordinates over the
// width.
TEST(RegionOutline, CommonPartOfTwoDiscs) {
    for (const double apart : {0.5, 2.0, 4.0, 4.8, 4.99, 4.9999}) {
        for (const bool sees_margin : {true, false}) {
            for (const bool is_mirror : {true, false}) {
                const optics::RegionOutline outline = optics::region_outline(
                    common_part({{{0.0, 0.0}, 3.0}, {{0.0, apart}, 2.0}}, sees_margin),
                    {.start = {0.0, 0.5 * (apart - 2.0 + 3.0)}, .reach = 7.0, .is_mirror = is_mirror});
                const double expected = apart < 1.0 ? 4.0 * kPi : lens_area(3.0, 2.0, apart);
                const double rounding = 1e-14 / std::min(4.0, 5.0 - apart);
                EXPECT_NEAR(outline.area / expected, 1.0, 1e-11 + rounding) << apart << " " << sees_margin << is_mirror;
            }
        }
    }
}

// A region whose own numbers are rounded, to 1e-6 of its radius, is not halved down to that, nor looked at from other
// places: some 60 pieces of 17 edges, each found in some 60 looks (1.8 million were taken without the rule).
TEST(RegionOutline, EndsAtTheRoundingOfTheRegion) {
    const optics::Region disc = common_part({{{0.0, 0.5}, 3.0}});
    constexpr double kStep = 3e-6;
    int looks = 0;
    const optics::Region rounded = [&](Vec2d at) {
        ++looks;
        return disc({kStep * std::round(at.x / kStep), kStep * std::round(at.y / kStep)});
    };
    const optics::RegionOutline outline = optics::region_outline(rounded, {.start = {}, .reach = 7.0});
    EXPECT_TRUE(outline.is_star_shaped);
    EXPECT_LT(outline.relative_error, 1e-5);
    EXPECT_NEAR(outline.area / (9.0 * kPi), 1.0, outline.relative_error);
    EXPECT_LT(looks, 100'000);
}

// A sliver far from where the search starts: 1e-4 as wide as the discs, found down the margin.
TEST(RegionOutline, FindsASliver) {
    const optics::Region region = common_part({{{0.3, -1.0}, 3.0}, {{0.3, 3.9999}, 2.0}});
    const optics::RegionOutline outline = optics::region_outline(region, {.start = {0.0, 0.0}, .reach = 8.0});
    EXPECT_NEAR(outline.area / lens_area(3.0, 2.0, 4.9999), 1.0, 1e-9);
    EXPECT_TRUE(
        optics::region_outline(common_part({{{0.0, 0.0}, 3.0}, {{0.0, 5.01}, 2.0}}), {.start = {}, .reach = 8.0})
            .is_empty());
}

// Three discs, no symmetry: Reuleaux's triangle of width w has the area (π − √3) w² / 2.
TEST(RegionOutline, ReuleauxTriangle) {
    std::vector<Disc> discs;
    for (const double azimuth : {0.2, 0.2 + 2.0 * kPi / 3.0, 0.2 + 4.0 * kPi / 3.0}) {
        discs.push_back({{std::cos(azimuth) / std::sqrt(3.0), std::sin(azimuth) / std::sqrt(3.0)}, 1.0});
    }
    const optics::RegionOutline outline =
        optics::region_outline(common_part(discs), {.start = {0.1, 0.1}, .reach = 2.0});
    EXPECT_NEAR(outline.area / (0.5 * (kPi - std::sqrt(3.0))), 1.0, 1e-11);
}

// ∫ y² over a disc about a point off its middle is π R⁴ / 4 + π R² y₀², and the weights add up to the area; the nodes
// need no more than two rings for a quadratic (degree 2 · 2 − 2).
TEST(RegionOutline, QuadratureIntegratesPolynomials) {
    const optics::RegionOutline outline =
        optics::region_outline(common_part({{{0.0, 0.5}, 3.0}}), {.start = {}, .reach = 7.0});
    double area = 0.0;
    double second = 0.0;
    for (const optics::RegionNode& node : optics::region_quadrature(outline, 2)) {
        area += node.weight;
        second += node.weight * node.point.y * node.point.y;
    }
    EXPECT_NEAR(area / (9.0 * kPi), 1.0, 1e-13);
    EXPECT_NEAR(second / (81.0 * kPi / 4.0 + 9.0 * kPi * 0.25), 1.0, 1e-12);
}

// A disc with a bite: star-shaped only about points with y > 1.05, where the tangents at the bite's ends meet the axis,
// and its centroid is not among them.
TEST(RegionOutline, CrescentIsSeenFromItsFarSide) {
    const optics::Region crescent = [](Vec2d at) {
        const double outer = (at.x * at.x + at.y * at.y) / 9.0 - 1.0;
        const double bite = 1.0 - (at.x * at.x + (at.y + 3.4) * (at.y + 3.4)) / (2.2 * 2.2);
        return bite > outer ? optics::RegionSample{bite, 1} : optics::RegionSample{outer, 0};
    };
    for (const bool is_mirror : {true, false}) {
        const optics::RegionOutline outline =
            optics::region_outline(crescent, {.start = {}, .reach = 7.0, .is_mirror = is_mirror});
        EXPECT_TRUE(outline.is_star_shaped);
        EXPECT_GT(outline.centre.y, 1.04);
        EXPECT_NEAR(outline.area / (9.0 * kPi - lens_area(2.2, 3.0, 3.4)), 1.0, 1e-11);
    }
}

// A banana: the part of an annulus, radii 10 and 10.3, within a wide disc about its middle. No point of it sees both
// tips. Its area is that between two circles cut by a third, from the circles' lenses; its nodes lie inside.
TEST(RegionOutline, BentStripIsStraightened) {
    const auto margin = [](Vec2d at, double y, double radius) {
        return (at.x * at.x + (at.y - y) * (at.y - y)) / (radius * radius) - 1.0;
    };
    const optics::Region banana = [&](Vec2d at) {
        optics::RegionSample worst{margin(at, 0.0, 10.3), 0};
        for (const optics::RegionSample& other :
             {optics::RegionSample{-margin(at, 0.0, 10.0), 1}, optics::RegionSample{margin(at, 10.1, 4.0), 2}}) {
            worst = other.margin > worst.margin ? other : worst;
        }
        return worst;
    };
    const optics::RegionOutline outline =
        optics::region_outline(banana, {.start = {0.0, 10.1}, .reach = 10.0, .is_mirror = true});
    EXPECT_TRUE(outline.is_star_shaped);
    EXPECT_NE(outline.bend, 0.0);
    EXPECT_NEAR(outline.area / (lens_area(4.0, 10.3, 10.1) - lens_area(4.0, 10.0, 10.1)), 1.0, 1e-10);
    double area = 0.0;
    for (const optics::RegionNode& node : optics::region_quadrature(outline, 4)) {
        EXPECT_LT(banana(node.point).margin, 0.0);
        area += node.weight;
    }
    EXPECT_NEAR(area / outline.area, 1.0, 1e-13);
}

// An annulus is not star-shaped, and said not to be.
TEST(RegionOutline, SaysWhereItIsNotStarShaped) {
    const optics::Region annulus = [](Vec2d at) {
        const double r2 = at.x * at.x + at.y * at.y;
        return r2 < 1.0 ? optics::RegionSample{1.0 - r2, 1} : optics::RegionSample{r2 / 9.0 - 1.0, 0};
    };
    EXPECT_FALSE(optics::region_outline(annulus, {.start = {0.0, 1.5}, .reach = 7.0}).is_star_shaped);
}

}  // namespace lensproof::analysis::beam_outline_test
