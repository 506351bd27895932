#include "engine/polynomial/symmetric_map.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "engine/polynomial/exit_chart.h"
#include "engine/polynomial/sparse_fit.h"

namespace lensproof::polynomial::symmetric_map_test {
namespace {

SymmetricMap some_map() {
    return {2,
            {{{{0, 0, 0, 0}, 0.9}, {{2, 0, 1, 0}, -0.2}},
             {{{0, 1, 0, 1}, 0.3}, {{0, 0, 3, 0}, 0.1}},
             {{{1, 0, 0, 0}, 0.4}},
             {{{0, 0, 0, 0}, 1.1}, {{1, 1, 1, 2}, 0.2}},
             {{{0, 0, 0, 0}, 0.5}, {{0, 2, 0, 0}, 0.25}}}};
}

const SymmetricPoint kPoint{{0.3, -0.6}, {0.5, 0.2}, 0.7};

// By hand: x·x = 0.45, q·q = 0.29, x·q = 0.03.
TEST(SymmetricMap, IsItsFormula) {
    const double xx = 2.0 * 0.45 - 1.0;
    const double qq = 2.0 * 0.29 - 1.0;
    const double xq = 0.03;
    const double a = 0.9 - 0.2 * xx * xx * xq;
    const double b = 0.3 * qq * 0.7 + 0.1 * xq * xq * xq;
    const SymmetricMap map = some_map();
    EXPECT_NEAR(map.vector(0, kPoint).x, a * 0.3 + b * 0.5, 1e-15);
    EXPECT_NEAR(map.vector(0, kPoint).y, a * -0.6 + b * 0.2, 1e-15);
    EXPECT_NEAR(map.scalar(0, kPoint), 0.5 + 0.25 * qq * qq, 1e-15);
    EXPECT_EQ(map.scalars(), 1);
    EXPECT_EQ(map.terms(), 9);
    EXPECT_EQ(map.degree(), 7);  // of (x·x)² (x·q) x and, but for the wavelength, (x·x) (q·q) (x·q) q
}

TEST(SymmetricMap, CommutesWithTurnsAndMirrors) {
    const SymmetricMap map = some_map();
    const double angle = 1.1;
    const auto turned = [&](Vec2d v) {
        return Vec2d{std::cos(angle) * v.x - std::sin(angle) * v.y, -std::sin(angle) * v.x - std::cos(angle) * v.y};
    };
    const SymmetricPoint other{turned(kPoint.x), turned(kPoint.q), kPoint.t};
    const Vec2d expected = turned(map.vector(1, kPoint));
    EXPECT_NEAR(map.vector(1, other).x, expected.x, 1e-15);
    EXPECT_NEAR(map.vector(1, other).y, expected.y, 1e-15);
}

// Differences over 1e-5 on either side err by 1e-10 of the third derivative, which is about 1, and by 1e-11 of
// rounding.
TEST(SymmetricMap, SlopesAreDifferences) {
    const SymmetricMap map = some_map();
    constexpr double kStep = 1e-5;
    const auto slopes = map.slopes(kPoint);
    for (int which = 0; which < 2; ++which) {
        for (std::size_t i = 0; i < 2; ++i) {
            const Vec2d along = i == 0 ? Vec2d{kStep, 0.0} : Vec2d{0.0, kStep};
            const auto difference = [&](Vec2d of_x, Vec2d of_q) {
                const Vec2d ahead = map.vector(which, {kPoint.x + of_x, kPoint.q + of_q, kPoint.t});
                const Vec2d behind = map.vector(which, {kPoint.x - of_x, kPoint.q - of_q, kPoint.t});
                return 0.5 / kStep * (ahead - behind);
            };
            const VectorSlopes& of = slopes[static_cast<std::size_t>(which)];
            EXPECT_NEAR(length(of.by_x[i] - difference(along, {})), 0.0, 1e-9);
            EXPECT_NEAR(length(of.by_q[i] - difference({}, along)), 0.0, 1e-9);
        }
        EXPECT_EQ(slopes[static_cast<std::size_t>(which)].value, map.vector(which, kPoint));
    }
}

TEST(SymmetricMap, ComesBackFromItsBytesAndFromNoOthers) {
    std::string bytes;
    some_map().append_to(bytes);
    std::string_view left = bytes;
    const auto back = SymmetricMap::taken_from(left);
    ASSERT_TRUE(back);
    EXPECT_TRUE(left.empty());
    EXPECT_EQ(back->vector(0, kPoint), some_map().vector(0, kPoint));
    EXPECT_EQ(back->degree(), some_map().degree());
    for (std::size_t cut = 0; cut < bytes.size(); ++cut) {
        left = std::string_view(bytes).substr(0, cut);
        EXPECT_FALSE(SymmetricMap::taken_from(left)) << cut;
    }
}

TEST(SymmetricMap, HasRoomForSoManyMonomials) {
    std::vector<SymmetricMap::Term> terms;
    for (std::uint8_t i = 0; i < 30; ++i) {
        for (std::uint8_t k = 0; k < 30; ++k) {
            terms.push_back({{i, k, 0, 0}, 1.0});
        }
    }
    EXPECT_THROW(SymmetricMap(0, {terms}), std::length_error);
}

// Rays at up to 115° from the axis, from the sphere's vertex to near its equator, and from a plane: there and back to
// rounding.
TEST(ExitChart, IsOneToOneBeyond90Degrees) {
    for (const double curvature : {0.0, 0.02, -0.01}) {
        for (const double height : {0.0, 20.0, 48.0}) {
            for (const double field : {0.0, 0.8, 1.5708, 2.0}) {
                const double c2 = curvature * curvature;
                const double z = curvature * height * height / (1.0 + std::sqrt(1.0 - c2 * height * height));
                const Ray<double> ray{{0.6 * height, -0.8 * height, z},
                                      {std::sin(field) * 0.28, std::sin(field) * 0.96, -std::cos(field)}};
                const ExitPoint<double> at = exit_point(ray, curvature);
                EXPECT_NEAR(length(at.w), std::tan(0.5 * field), 1e-15);
                const Ray<double> back = exit_ray(at, curvature);
                EXPECT_NEAR(length(back.origin - ray.origin), 0.0, 1e-13);
                EXPECT_NEAR(length(back.direction - ray.direction), 0.0, 1e-15);
            }
        }
    }
}

// The etendue of a plane's rays is cos θ dA dω, with dω of w = tan(θ/2) and u half a length.
TEST(ExitChart, EtendueIsThatOfAreaAndSolidAngle) {
    const double field = 0.9;
    const double half = std::tan(0.5 * field);
    // dω / dw = sin θ dθ dφ / (w dw dφ), dw/dθ = (1 + w²) / 2.
    const double solid_angle = std::sin(field) / (half * 0.5 * (1.0 + half * half));
    EXPECT_NEAR(etendue_density({.u = {1.0, 2.0}, .w = {half, 0.0}}, 0.0), std::cos(field) * 4.0 * solid_angle, 1e-14);
}

// Columns are powers of 40 points, the target three of them and a hundredth of noise of known size: the three are
// found, and more than the noise is never explained.
TEST(SparseFit, FindsTheTermsThatAreThere) {
    Eigen::MatrixXd columns(40, 8);
    for (Eigen::Index r = 0; r < 40; ++r) {
        for (Eigen::Index k = 0; k < 8; ++k) {
            columns(r, k) = std::pow(-1.0 + 2.0 * static_cast<double>(r) / 39.0, static_cast<double>(k));
        }
    }
    const Eigen::VectorXd target = 2.0 * columns.col(1) - 3.0 * columns.col(4) + 0.5 * columns.col(7);
    const SparseFit exact = sparse_fit(columns, target, 1e-12, 8);
    EXPECT_LT((columns(Eigen::all, exact.terms) * exact.coefficients - target).norm(), 1e-12);
    EXPECT_LT(exact.rms, 1e-12);
    const SparseFit rough = sparse_fit(columns, target, 0.2, 8);
    EXPECT_LT(rough.terms.size(), exact.terms.size());
    EXPECT_LE(rough.rms, 0.2);
    EXPECT_EQ(sparse_fit(columns, target, 0.0, 2).terms.size(), 2U);
    EXPECT_TRUE(sparse_fit(columns, Eigen::VectorXd::Zero(40), 1e-9, 8).terms.empty());
}

}  // namespace
}  // namespace lensproof::polynomial::symmetric_map_test
