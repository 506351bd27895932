#include "engine/optics/edge_rays.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <random>
#include <vector>

#include "engine/base/angle.h"
#include "engine/base/infinity.h"
#include "engine/optics/polygon_transform.h"

namespace lensproof::optics::edge_rays_test {

using std::numbers::pi;

StopMask blades(int count, double curvature = 0.0) {
    return StopMask(PolygonStop{.blades = count, .curvature = curvature, .rotation_deg = 10.0});
}

/// The corners of `blades`.
std::vector<Vec2d> corners(int count) {
    std::vector<Vec2d> polygon(static_cast<std::size_t>(count));
    for (int i = 0; i < count; ++i) {
        const double azimuth = radians(10.0) + 2 * pi * i / count;
        polygon[static_cast<std::size_t>(i)] = {std::cos(azimuth), std::sin(azimuth)};
    }
    return polygon;
}

TEST(StopMask, KnowsItsEdgesLengthAndArea) {
    EXPECT_NEAR(blades(6).perimeter(), 6.0, 1e-14);
    EXPECT_NEAR(blades(6).area(), 1.5 * std::sqrt(3.0), 1e-14);
    EXPECT_NEAR(blades(5, 1.0).perimeter(), 2 * pi, 1e-12) << "blades of the circle's own curvature";
    EXPECT_NEAR(blades(5, 1.0).area(), pi, 1e-12);
    EXPECT_NEAR(StopMask().perimeter(), 2 * pi, 1e-15);
    // Half-round blades, by counting points of a grid: to its step times the perimeter.
    const StopMask half = blades(7, 0.5);
    int inside = 0;
    constexpr int kSide = 2000;
    for (int row = 0; row < kSide; ++row) {
        for (int column = 0; column < kSide; ++column) {
            const double x = 2.0 * (column + 0.5) / kSide - 1.0;
            const double y = 2.0 * (row + 0.5) / kSide - 1.0;
            inside += x * x + y * y < 1.0 && half.transmittance(x, y) > 0.0 ? 1 : 0;
        }
    }
    EXPECT_NEAR(4.0 * inside / (kSide * kSide), half.area(), 1e-4);
}

TEST(StopMask, FindsTheEdgesBesideAPoint) {
    const StopMask square(PolygonStop{.blades = 4, .curvature = 0.0, .rotation_deg = 45.0});  // |x|, |y| < √½
    const double side = std::sqrt(0.5);
    const auto right = square.edges_near(side - 0.01, 0.1, 0.05);
    ASSERT_EQ(right.size(), 1U);
    EXPECT_NEAR(right[0].distance, 0.01, 1e-15);
    EXPECT_NEAR(right[0].outward.x, 1.0, 1e-15);
    EXPECT_EQ(square.edges_near(side - 0.01, 0.03 - side, 0.05).size(), 2U);
    EXPECT_TRUE(square.edges_near(0.0, 0.0, 0.05).empty());
    const auto round = StopMask().edges_near(0.0, -0.98, 0.05);
    ASSERT_EQ(round.size(), 1U);
    EXPECT_NEAR(round[0].distance, 0.02, 1e-15);
    EXPECT_EQ(round[0].outward.y, -1.0);
    // An edge between straight and round: the foot lies on the disc that bounds it.
    const StopMask half = blades(6, 0.5);
    const double azimuth = radians(10.0 + 37.0);
    const auto curved = half.edges_near(0.88 * std::cos(azimuth), 0.88 * std::sin(azimuth), 0.2);
    ASSERT_EQ(curved.size(), 1U);
    const Vec2d foot{0.88 * std::cos(azimuth) + curved[0].distance * curved[0].outward.x,
                     0.88 * std::sin(azimuth) + curved[0].distance * curved[0].outward.y};
    EXPECT_NEAR(half.edge_margin(foot.x, foot.y).margin, 0.0, 1e-14);
}

// Points at even shares lie on the edges, at even distances, with the direction across that a point beside has.
TEST(StopMask, WalksAlongItsEdges) {
    for (const StopMask& mask : {StopMask(), blades(5), blades(6, 0.5)}) {
        constexpr int kSteps = 3000;
        double length_of_steps = 0.0;
        for (int i = 0; i < kSteps; ++i) {
            const auto here = mask.edge_at((i + 0.5) / kSteps);
            const auto next = mask.edge_at((i + 1.5) / kSteps - (i + 1 == kSteps ? 1.0 : 0.0));
            length_of_steps += length(next.point - here.point);
            const Vec2d inside = here.point - 1e-3 * here.outward;
            EXPECT_GT(mask.transmittance(inside.x, inside.y), 0.0);
            const auto edges = mask.edges_near(inside.x, inside.y, 1.01e-3);
            ASSERT_GE(edges.size(), 1U);
            const bool is_found = std::ranges::any_of(edges, [&](const auto& edge) {
                return std::abs(edge.distance - 1e-3) < 1e-12 && length(edge.outward - here.outward) < 1e-9;
            });
            EXPECT_TRUE(is_found) << i;
        }
        EXPECT_NEAR(length_of_steps / mask.perimeter(), 1.0, 1e-3) << "six chords that cut corners by half a step";
    }
}

/// What falls beyond angles of a far field, of a million rays straight through the opening.
std::vector<double> fractions_beyond(const StopMask& mask, double semi_diameter, double wavelength,
                                     const std::vector<double>& angles) {
    const StopPlane stop{&mask, semi_diameter, 2 * pi / wavelength};
    const EdgeZone zone{.width = 0.05, .deflections = {angles.front(), 0.5}};
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> unit;
    std::vector<double> sums(angles.size());
    int inside = 0;
    for (int i = 0; i < 1'000'000; ++i) {
        const Vec2d point{2 * unit(random) - 1, 2 * unit(random) - 1};
        if (point.x * point.x + point.y * point.y > 1.0 || mask.transmittance(point.x, point.y) == 0.0) {
            continue;
        }
        ++inside;
        const auto ray = diffracted(stop, zone, {semi_diameter * point.x, semi_diameter * point.y}, {0, 0, 1},
                                    {unit(random), unit(random), unit(random), unit(random)});
        const double angle = ray ? std::hypot(ray->direction.x, ray->direction.y) : 0.0;
        for (std::size_t k = 0; k < angles.size(); ++k) {
            sums[k] += angle > angles[k] ? ray->weight : 0.0;
        }
    }
    for (double& sum : sums) {
        sum /= inside;
    }
    return sums;
}

/// The same of the wave: 1 less what a regular polygon's transform has within the angle, a sector being like the
/// others.
double wave_beyond(const std::vector<Vec2d>& polygon, double semi_diameter, double wavelength, double angle) {
    const double area = polygon_transform(polygon, {}).real();
    const double k = 2 * pi * semi_diameter * std::sin(angle) / wavelength;
    const double sector = 2 * pi / static_cast<double>(polygon.size());
    constexpr int kAngles = 120;
    const auto ring = [&](double radius) {
        double sum = 0.0;
        for (int j = 0; j < kAngles; ++j) {
            const double azimuth = sector * (j + 0.5) / kAngles;
            sum += std::norm(polygon_transform(polygon, {radius * std::cos(azimuth), radius * std::sin(azimuth)}));
        }
        return sum * radius * (2 * pi / kAngles);
    };
    const int pairs = 1 + static_cast<int>(2 * k);  // of steps of a quarter: Simpson's rule, to 1e-5 of a period of 2π
    const double step = k / (2 * pairs);
    double within = 0.0;
    for (int i = 0; i < pairs; ++i) {
        const double radius = 2 * i * step;
        within += step / 3 * (ring(radius) + 4 * ring(radius + step) + ring(radius + 2 * step));
    }
    return 1.0 - within / (4 * pi * pi * area);
}

// At f/8 and f/22 of a 50 mm lens, from 5 to 100 λN: the wave's fraction beyond 5 λN within 5 %, which oscillates there
// by as much, and beyond 20 λN within 3 %. (A million rays leave 0.7 %.)
TEST(EdgeRays, LandWhereTheWaveDoes) {
    const double wavelength = 550e-6;
    for (const double f_number : {8.0, 22.0}) {
        const double semi_diameter = 25.0 / f_number;
        const auto angle_of = [&](double airy) { return airy * wavelength * f_number / 50.0; };
        for (const int count : {5, 6, 8, 9}) {
            const auto fractions =
                fractions_beyond(blades(count), semi_diameter, wavelength, {angle_of(5), angle_of(20), angle_of(100)});
            const std::vector<Vec2d> polygon = corners(count);
            EXPECT_NEAR(fractions[0] / wave_beyond(polygon, semi_diameter, wavelength, angle_of(5)), 1.0, 0.05)
                << count;
            EXPECT_NEAR(fractions[1] / wave_beyond(polygon, semi_diameter, wavelength, angle_of(20)), 1.0, 0.03)
                << count;
        }
    }
}

// The circle's, 1 − J₀² − J₁² beyond an angle, and its limit; the tail from 5 to 100 λN falls as 1/θ.
TEST(EdgeRays, OfACircleAreAirysTail) {
    const double wavelength = 550e-6;
    const double semi_diameter = 50.0 / 16.0;
    const StopMask circle;
    const auto angle_of = [&](double airy) { return airy * wavelength * 8.0 / 50.0; };
    const auto fractions =
        fractions_beyond(circle, semi_diameter, wavelength, {angle_of(5), angle_of(20), angle_of(100)});
    const auto airy_beyond = [&](double airy) {
        const double x = pi * airy;  // k a sin θ = π r / (λ N)
        return std::cyl_bessel_j(0, x) * std::cyl_bessel_j(0, x) + std::cyl_bessel_j(1, x) * std::cyl_bessel_j(1, x);
    };
    EXPECT_NEAR(airy_beyond(5), 0.03926, 5e-6);
    EXPECT_NEAR(fractions[0] / airy_beyond(5), 1.0, 0.05);
    EXPECT_NEAR(fractions[1] / airy_beyond(20), 1.0, 0.03);
    const double slope = std::log(fractions[2] / fractions[0]) / std::log(20.0);
    EXPECT_NEAR(slope, -1.0, 0.05);
    const StopPlane stop{&circle, semi_diameter, 2 * pi / wavelength};
    EXPECT_NEAR(diffracted_fraction(stop, angle_of(5)), 0.04053, 5e-6);
    EXPECT_NEAR(fractions[0] / diffracted_fraction(stop, angle_of(5)), 1.0, 0.02);
}

// Of straight blades all rays leave at right angles to an edge, two streaks for each blade where they are odd in
// number; in a beam that is aslant too, along the edge unturned (Keller's cone): so is the middle of what an edge
// spreads.
TEST(EdgeRays, StandAtRightAnglesToTheBlades) {
    const StopMask five = blades(5);
    const StopPlane stop{&five, 2.0, 2 * pi / 550e-6};
    const EdgeZone zone{.width = 0.05, .deflections = {1e-3, 0.3}};
    const Vec3<double> slant = normalized(Vec3<double>{0.2, -0.1, 1.0});
    std::mt19937_64 random(2);
    std::uniform_real_distribution<double> unit;
    std::vector<int> streaks(10);
    for (int i = 0; i < 20'000; ++i) {
        const Vec2d point{2 * unit(random) - 1, 2 * unit(random) - 1};
        const std::array<double, 4> numbers{unit(random), unit(random), unit(random), 0.5};
        if (point.x * point.x + point.y * point.y > 1.0 || five.transmittance(point.x, point.y) == 0.0) {
            continue;
        }
        for (const Vec3<double>& direction : {Vec3<double>{0, 0, 1}, slant}) {
            const auto ray = diffracted(stop, zone, {2.0 * point.x, 2.0 * point.y}, direction, numbers);
            if (!ray) {
                continue;
            }
            EXPECT_NEAR(length(ray->direction), 1.0, 1e-14);
            const auto edges = five.edges_near(point.x, point.y, zone.width);
            double least_turn = 1.0;
            for (const auto& edge : edges) {
                const Vec3<double> along{-edge.outward.y, edge.outward.x, 0.0};
                least_turn = std::min(least_turn, std::abs(dot(ray->direction - direction, along)));
            }
            EXPECT_LT(least_turn, 1e-14);
            if (direction.x == 0.0) {
                const double azimuth = degrees(std::atan2(ray->direction.y, ray->direction.x)) - 10.0;
                const double streak = (azimuth + 360.0) / 36.0;  // the blades' normals lie at 36°, 108°, …
                EXPECT_NEAR(streak, std::round(streak), 0.2 / 36.0);
                ++streaks[static_cast<std::size_t>(std::lround(streak)) % 10];
            }
        }
    }
    for (const int count : streaks) {
        EXPECT_GT(count, 50);
    }
}

// What an edge of length ℓ deflects by θ is spread along it by sinc²(kθℓs/2), s the turn's sine: by Simpson's rule, at
// reaches kθℓ/2 where it is cut short, where its series ends, and where it is narrow. The weights' mean is 1: 1e5 even
// numbers leave nothing of chance, and the series 2e-4.
TEST(EdgeRays, AreSpreadAlongTheEdgeAsItsTransformIs) {
    constexpr double kLength = 2.0;
    constexpr double kWavenumber = 2 * pi / 550e-6;
    const auto sinc2 = [](double x) { return x == 0.0 ? 1.0 : std::sin(x) * std::sin(x) / (x * x); };
    for (const double reach : {0.5, 2.0, 4.9, 5.1, 40.0}) {
        const double theta = std::asin(2.0 * reach / (kWavenumber * kLength));
        const DeflectionRange narrow{theta, theta * (1.0 + 1e-9)};
        const auto within = [&](double end) {
            constexpr int kSteps = 4000;
            double sum = 0.0;
            for (int i = 0; i <= kSteps; ++i) {
                sum += (i == 0 || i == kSteps ? 1.0 : 2.0 + 2.0 * (i % 2)) * sinc2(end * i / kSteps);
            }
            return sum * end / (3.0 * kSteps);
        };
        const double on_the_cone =
            diffracted_at_edge({{1, 0}, kInfinity}, kWavenumber, {0, 0, 1}, narrow, {0.9, 0.5}).weight;
        double weight = 0.0;
        double weight_within = 0.0;  // half the reach
        constexpr int kNumbers = 100'000;
        for (int i = 0; i < kNumbers; ++i) {
            const auto ray =
                diffracted_at_edge({{1, 0}, kLength}, kWavenumber, {0, 0, 1}, narrow, {0.9, (i + 0.5) / kNumbers});
            EXPECT_NEAR(std::hypot(ray.direction.x, ray.direction.y), std::sin(theta), 1e-3 * theta);
            const double turned = ray.weight / on_the_cone / kNumbers;
            weight += turned;
            weight_within += std::abs(ray.direction.y) < 0.5 * std::sin(theta) ? turned : 0.0;
        }
        EXPECT_NEAR(weight, 1.0, 3e-4) << reach;
        EXPECT_NEAR(weight_within, within(0.5 * reach) / within(reach), 5e-4) << reach;
    }
}

}  // namespace lensproof::optics::edge_rays_test
