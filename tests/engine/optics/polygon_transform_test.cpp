#include "engine/optics/polygon_transform.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace lensproof::optics::polygon_transform_test {

using std::numbers::pi;

/// Of circumradius 1, a corner on +x.
std::vector<Vec2d> regular(int corners) {
    std::vector<Vec2d> polygon(static_cast<std::size_t>(corners));
    for (int i = 0; i < corners; ++i) {
        polygon[static_cast<std::size_t>(i)] = {std::cos(2 * pi * i / corners), std::sin(2 * pi * i / corners)};
    }
    return polygon;
}

double relative_power(const std::vector<Vec2d>& polygon, const Vec2d& k) {
    return std::norm(polygon_transform(polygon, k) / polygon_transform(polygon, {}));
}

// From 30 digits: towards a corner, and along an edge's normal.
TEST(PolygonTransform, OfAHexagonIsThePublishedOne) {
    const double slant = std::sqrt(0.75);
    EXPECT_NEAR(relative_power(regular(6), {10, 0}), 8.96377596e-4, 5e-13);
    EXPECT_NEAR(relative_power(regular(6), {30, 0}), 7.33309330e-6, 5e-15);
    EXPECT_NEAR(relative_power(regular(6), {10 * slant, 5}), 0.00470447642, 5e-12);
    EXPECT_NEAR(relative_power(regular(6), {30 * slant, 15}), 3.83323993e-4, 5e-13);
}

TEST(PolygonTransform, OfARectangleIsTheProductOfItsSides) {
    const std::vector<Vec2d> rectangle = {{-1, -0.5}, {-1, 0.5}, {1, 0.5}, {1, -0.5}};  // clockwise
    for (const Vec2d& k : {Vec2d{3.0, 4.0}, {0.3, -7.0}, {-2.0, 1e-3}}) {
        const double expected = 4.0 * std::sin(k.x) / k.x * std::sin(0.5 * k.y) / k.y;
        EXPECT_NEAR(std::abs(polygon_transform(rectangle, k) - expected), 0.0, 1e-14);
    }
    EXPECT_EQ(polygon_transform(rectangle, {}), 2.0);
}

TEST(PolygonTransform, OfAMovedPolygonIsTurnedInPhase) {
    std::vector<Vec2d> moved = regular(5);
    for (Vec2d& corner : moved) {
        corner = {corner.x + 0.3, corner.y - 0.2};
    }
    const Vec2d k{4.0, 7.0};
    EXPECT_NEAR(std::abs(polygon_transform(moved, k) -
                         polygon_transform(regular(5), k) * std::polar(1.0, -(0.3 * k.x - 0.2 * k.y))),
                0.0, 1e-14);
}

// Beyond k the far field has the fraction P / (π A k), whatever the shape (perimeter, area): P λ f / (2π² A r) in a
// focal plane. By a sum over the ring between k and 2k, whose share tends to half of that; what oscillates with k is
// averaged over the ring but for some 1/k of it.
TEST(PolygonTransform, FallsOffAsItsPerimeterSays) {
    for (const int corners : {3, 5, 6, 8}) {
        const std::vector<Vec2d> polygon = regular(corners);
        const double area = 0.5 * corners * std::sin(2 * pi / corners);
        const double perimeter = 2 * corners * std::sin(pi / corners);
        constexpr double kFrom = 60.0;
        constexpr int kRadii = 400;
        const int angles = 2880 / corners;  // of a sector, the others being like it; an edge's streak is some 1/k wide
        double sum = 0.0;
        for (int i = 0; i < kRadii; ++i) {
            const double k = kFrom * (1.0 + (i + 0.5) / kRadii);
            double ring = 0.0;
            for (int j = 0; j < angles; ++j) {
                const double angle = 2 * pi * (j + 0.5) / (corners * angles);
                ring += std::norm(polygon_transform(polygon, {k * std::cos(angle), k * std::sin(angle)}));
            }
            sum += ring * k * (kFrom / kRadii) * (2 * pi / angles);
        }
        const double fraction = sum / (4 * pi * pi * area);
        EXPECT_NEAR(fraction / (0.5 * perimeter / (pi * area * kFrom)), 1.0, 1.0 / kFrom) << corners;
    }
}

}  // namespace lensproof::optics::polygon_transform_test
