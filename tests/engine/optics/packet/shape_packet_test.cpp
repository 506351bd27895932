// Shapes that are no spheres, met by several rays in step: each lane against the ray alone, bit by bit.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <random>

#include "engine/base/infinity.h"
#include "engine/base/pack.h"
#include "engine/optics/surface_shape.h"

namespace lensproof::optics::shape_packet_test {

using Random = std::mt19937_64;

template <class Scalar>
using Eight = Pack<Scalar, std::experimental::simd_abi::fixed_size<8>>;
template <class Scalar>
using Four = Pack<Scalar, std::experimental::simd_abi::fixed_size<4>>;

double unit(Random& random) {
    return std::uniform_real_distribution<double>(-1.0, 1.0)(random);
}

/// Equal to the last bit, the sign of a zero too. Nobody promises the bits of what is not a number.
template <class Scalar>
bool is_same(Scalar a, Scalar b) {
    return (a == b && std::signbit(a) == std::signbit(b)) || (std::isnan(a) && std::isnan(b));
}

template <class Numbers, class Scalar>
bool is_same(const Vec3<Numbers>& pack, int lane, const Vec3<Scalar>& alone) {
    return is_same(pack.x[lane], alone.x) && is_same(pack.y[lane], alone.y) && is_same(pack.z[lane], alone.z);
}

template <class Scalar>
struct ShapeRay {
    Vec3<Scalar> origin;
    Vec3<Scalar> direction;
};

/// Towards the vertex's neighbourhood from all sides, some along the vertex's plane and some far beyond the surface.
template <class Scalar>
ShapeRay<Scalar> random_ray(Random& random, int i) {
    const Scalar steep(i % 3 == 0 ? 3.0 : 0.4);
    const Scalar along(i % 11 == 0 ? 0.0 : i % 5 == 0 ? -1.0 : 1.0);
    const Vec3<Scalar> direction =
        normalized(Vec3<Scalar>{steep * Scalar(unit(random)), steep * Scalar(unit(random)), along});
    const Vec3<Scalar> near_vertex{Scalar(20.0 * unit(random)), Scalar(20.0 * unit(random)),
                                   Scalar(5.0 * unit(random))};
    return {near_vertex - Scalar(20.0 + 10.0 * unit(random)) * direction, direction};
}

/// What happened to the rays, so that a test can say that it saw it.
struct Seen {
    int hits = 0;
    int misses = 0;
    int later_starts = 0;   // found, though not from where Newton's method starts first
    int halvings = 0;       // found, though a step led to where there is no surface or the ray leaves it
    int divided_packs = 0;  // lanes that hit beside lanes that miss
};

/// Where Newton's method starts first.
template <class Scalar>
Scalar first_start(const SurfaceShape<Scalar>& shape, const ShapeRay<Scalar>& ray, Scalar heading) {
    const Intersection<Scalar> conic =
        intersect_conic(ray.origin, ray.direction, shape.curvature, shape.conic, heading).first;
    return !shape.is_toroid && conic.hit ? conic.distance : -ray.origin.z / ray.direction.z;
}

/// Whether the first step from the first start has to be halved.
template <class Scalar>
bool oversteps(const SurfaceShape<Scalar>& shape, const ShapeRay<Scalar>& ray, Scalar heading) {
    const auto crosses = [&](const Implicit<Scalar>& at) {
        return at.defined && dot(at.gradient, ray.direction) * heading > Scalar(0);
    };
    const Vec3<Scalar> start = ray.origin + first_start(shape, ray, heading) * ray.direction;
    const Implicit<Scalar> here = implicit_surface(shape, start);
    const Scalar ahead = -here.value / dot(here.gradient, ray.direction);
    return crosses(here) && !crosses(implicit_surface(shape, start + ahead * ray.direction));
}

template <class Scalar>
void count(Seen& seen, const SurfaceShape<Scalar>& shape, const ShapeRay<Scalar>& ray, Scalar heading, bool hit) {
    ++(hit ? seen.hits : seen.misses);
    if (hit && !shape.is_conic()) {
        const Scalar start = first_start(shape, ray, heading);
        const bool at_once = newton_intersect(shape, ray.origin, ray.direction, heading, start, true).found;
        seen.later_starts += at_once ? 0 : 1;
        seen.halvings += at_once && oversteps(shape, ray, heading) ? 1 : 0;
    }
}

/// A shape by its number, in double.
using Family = std::function<SurfaceShape<double>(Random&, int)>;

template <class Scalar>
SurfaceShape<Scalar> in_precision(const SurfaceShape<double>& shape) {
    SurfaceShape<Scalar> to{.curvature = static_cast<Scalar>(shape.curvature),
                            .conic = static_cast<Scalar>(shape.conic),
                            .terms = shape.terms,
                            .odd_terms = shape.odd_terms,
                            .along_normal = shape.along_normal,
                            .is_toroid = shape.is_toroid,
                            .curvature_x = static_cast<Scalar>(shape.curvature_x)};
    for (std::size_t i = 0; i < to.asphere.size(); ++i) {
        to.asphere[i] = static_cast<Scalar>(shape.asphere[i]);
        to.odd_asphere[i] = static_cast<Scalar>(shape.odd_asphere[i]);
    }
    return to;
}

/// Every number that the shape gives for the rays of a pack, lane by lane against the ray alone.
template <class Numbers, class Scalar, int N>
void compare_pack(const SurfaceShape<Scalar>& shape, const std::array<ShapeRay<Scalar>, N>& rays, Scalar heading,
                  Seen& seen) {
    ShapeRay<Numbers> together;
    for (int lane = 0; lane < N; ++lane) {
        const ShapeRay<Scalar>& ray = rays[static_cast<std::size_t>(lane)];
        const auto set = [lane](Vec3<Numbers>& to, const Vec3<Scalar>& from) {
            to.x.set(lane, from.x);
            to.y.set(lane, from.y);
            to.z.set(lane, from.z);
        };
        set(together.origin, ray.origin);
        set(together.direction, ray.direction);
    }
    const auto [met, normals] = intersect(shape, together.origin, together.direction, Numbers(heading));
    const Vec3<Numbers> points = together.origin + Numbers(Scalar(20)) * together.direction;
    const Implicit<Numbers> values = implicit_surface(shape, points);
    const Numbers sags = sag(shape, points.x, points.y);
    int hits = 0;
    for (int lane = 0; lane < N; ++lane) {
        const ShapeRay<Scalar>& ray = rays[static_cast<std::size_t>(lane)];
        const auto [alone, normal] = intersect(shape, ray.origin, ray.direction, heading);
        ASSERT_EQ(met.hit[lane], alone.hit);
        ASSERT_TRUE(is_same(met.point, lane, alone.point));
        ASSERT_TRUE(is_same(met.distance[lane], alone.distance));
        ASSERT_TRUE(is_same(met.cos_incidence[lane], alone.cos_incidence));
        ASSERT_TRUE(is_same(met.sin2_incidence[lane], alone.sin2_incidence));
        ASSERT_TRUE(is_same(normals, lane, normal));
        const Vec3<Scalar> point = ray.origin + Scalar(20) * ray.direction;
        const Implicit<Scalar> value = implicit_surface(shape, point);
        ASSERT_EQ(values.defined[lane], value.defined);
        ASSERT_TRUE(is_same(values.value[lane], value.value));
        ASSERT_TRUE(is_same(values.largest_term[lane], value.largest_term));
        ASSERT_TRUE(is_same(values.gradient, lane, value.gradient));
        ASSERT_TRUE(is_same(sags[lane], sag(shape, point.x, point.y)));
        hits += alone.hit ? 1 : 0;
        count(seen, shape, ray, heading, alone.hit);
    }
    seen.divided_packs += hits > 0 && hits < N ? 1 : 0;
}

template <class Numbers, class Scalar, int N>
void compare_family(const Family& family, Seen& seen) {
    constexpr int kShapes = 100;
    constexpr int kPacks = 20;
    Random random(17);
    for (int i = 0; i < kShapes && !testing::Test::HasFatalFailure(); ++i) {
        const auto shape = in_precision<Scalar>(family(random, i));
        SCOPED_TRACE("shape " + std::to_string(i));
        for (int k = 0; k < kPacks; ++k) {
            std::array<ShapeRay<Scalar>, N> rays;
            for (int lane = 0; lane < N; ++lane) {
                rays[static_cast<std::size_t>(lane)] = random_ray<Scalar>(random, k + 5 * lane);
            }
            compare_pack<Numbers, Scalar, N>(shape, rays, Scalar(k % 4 == 0 ? -1 : 1), seen);
        }
    }
}

Seen compare(const Family& family) {
    Seen seen;
    compare_family<Eight<float>, float, 8>(family, seen);
    compare_family<Four<double>, double, 4>(family, seen);
    EXPECT_GT(seen.hits, 1000);
    EXPECT_GT(seen.misses, 1000);
    EXPECT_GT(seen.divided_packs, 300);
    return seen;
}

/// Conic constants from hyperboloids of −3 over paraboloids and spheres to oblate ellipsoids of 1000.
SurfaceShape<double> conic_shape(Random& random, int i) {
    SurfaceShape<double> shape{.curvature = i % 7 == 0 ? 0.0 : unit(random) / 12.0};
    switch (i % 5) {
        case 0:
            shape.conic = -1.0;
            break;
        case 1:
            shape.conic = 0.0;
            break;
        case 2:
            shape.conic = std::pow(10.0, 3.0 * std::abs(unit(random)));
            break;
        default:
            shape.conic = -1.5 + 1.5 * unit(random);
            break;
    }
    return shape;
}

/// Terms that reach `height_mm` mm each at 14 mm off the axis.
SurfaceShape<double> asphere_shape(Random& random, int i, double height_mm) {
    SurfaceShape<double> shape = conic_shape(random, i);
    shape.terms = 2 + i % 9;
    for (int k = i % 2; k < shape.terms; ++k) {
        shape.asphere[static_cast<std::size_t>(k)] = height_mm * unit(random) / std::pow(14.0, 2 * k + 2);
    }
    return shape;
}

SurfaceShape<double> odd_asphere_shape(Random& random, int i, double height_mm) {
    SurfaceShape<double> shape = asphere_shape(random, i, height_mm);
    shape.odd_terms = 1 + i % 10;
    for (int k = i % 3 == 0 ? 0 : 1; k < shape.odd_terms; ++k) {
        shape.odd_asphere[static_cast<std::size_t>(k)] = height_mm * unit(random) / std::pow(14.0, 2 * k + 1);
    }
    return shape;
}

TEST(ShapePacket, OfConics) {
    compare(conic_shape);
}

TEST(ShapePacket, OfMildAspheres) {
    compare([](Random& random, int i) { return asphere_shape(random, i, 0.05); });
}

// Terms of 8 mm turn the surface over within the reach of the rays: Newton's method oversteps, and has to start again.
TEST(ShapePacket, OfAspheresThatTurnOver) {
    const Seen seen = compare([](Random& random, int i) { return asphere_shape(random, i, 8.0); });
    EXPECT_GT(seen.later_starts, 300);
    EXPECT_GT(seen.halvings, 100);
}

TEST(ShapePacket, OfOddAspheresAndCones) {
    compare([](Random& random, int i) { return odd_asphere_shape(random, i, 0.05); });
    const Seen seen = compare([](Random& random, int i) { return odd_asphere_shape(random, i, 8.0); });
    EXPECT_GT(seen.later_starts, 300);
    EXPECT_GT(seen.halvings, 100);
}

TEST(ShapePacket, OfTermsAlongTheNormal) {
    compare([](Random& random, int i) {
        SurfaceShape<double> shape = i % 2 == 0 ? asphere_shape(random, i, 0.05) : odd_asphere_shape(random, i, 0.5);
        shape.along_normal = true;
        return shape;
    });
}

TEST(ShapePacket, OfToroidsAndCylinders) {
    const Seen seen = compare([](Random& random, int i) {
        SurfaceShape<double> shape = i % 4 == 0 ? asphere_shape(random, i, 0.5) : conic_shape(random, i);
        shape.is_toroid = true;
        shape.curvature_x = i % 3 == 0 ? 0.0 : unit(random) / 15.0;
        return shape;
    });
    EXPECT_GT(seen.later_starts, 50);
    EXPECT_GT(seen.halvings, 100);
}

// A lane that is not asked for is not found, and those beside it are what they are without it.
TEST(ShapePacket, LanesThatAreNotWantedAreLeftAlone) {
    using Numbers = Four<double>;
    const SurfaceShape<double> shape{.curvature = 1.0 / 40.0, .asphere = {0.0, 1e-6}, .terms = 2};
    const Vec3<Numbers> origin{Numbers(2.0), Numbers(3.0), Numbers(-30.0)};
    const Vec3<Numbers> direction{Numbers(0.0), Numbers(0.28), Numbers(0.96)};
    Numbers start(30.0);
    start.set(1, kInfinity);
    const auto wanted = start < Numbers(1e6);
    const ShapeCrossing<Numbers> crossing = newton_intersect(shape, origin, direction, Numbers(1.0), start, wanted);
    const ShapeCrossing<double> alone =
        newton_intersect(shape, Vec3d{2.0, 3.0, -30.0}, Vec3d{0.0, 0.28, 0.96}, 1.0, 30.0, true);
    ASSERT_TRUE(alone.found);
    for (const int lane : {0, 1, 2, 3}) {
        EXPECT_EQ(crossing.found[lane], lane != 1);
        EXPECT_TRUE(lane == 1 || is_same(crossing.point, lane, alone.point));
    }
}

}  // namespace lensproof::optics::shape_packet_test
