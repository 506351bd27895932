// What is true of every lens: light finds its path back, étendue is conserved, and scaling, turning, mirroring or
// splitting a gap changes nothing. Held against lenses that nobody designed (tests/engine/random_lens.h).
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <limits>
#include <numbers>

#include "engine/base/infinity.h"
#include "engine/optics/convert_lens.h"
#include "engine/optics/trace.h"
#include "tests/engine/random_lens.h"

namespace lensproof::optics::trace_property_test {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
constexpr double kAnyWavelength = 587.5618;  // the indices are constants
constexpr int kLenses = 40;
constexpr int kRaysOfALens = 60;

template <class T>
TraceLens<T> traced_lens(const Prescription& prescription) {
    return at_wavelength<T>(make_lens(prescription, GlassCatalogue()), kAnyWavelength);
}

/// A random ray from the plane z = −30 to somewhere on the first surface's opening.
Ray<double> random_ray(RandomLenses& random, const TraceLens<double>& lens) {
    const double rim = std::sqrt(lens.surfaces.front().semi_diameter_squared);
    const Vec3d aim{rim * random.between(-1.0, 1.0), rim * random.between(-1.0, 1.0), 0.0};
    const Vec3d start{aim.x + random.between(-12.0, 12.0), aim.y + random.between(-12.0, 12.0), -30.0};
    return {start, normalized(aim - start)};
}

/// Up to where the ray meets the image plane.
template <class T>
Ray<T> image_ray(const TraceLens<T>& lens, const TracedRay<T>& traced) {
    return {meet_plane(traced.ray, lens.image_z).point, traced.ray.direction};
}

/// How far apart two rays are: the larger of the distance of their points and 100 mm times that of their directions.
double apart(const Ray<double>& a, const Ray<double>& b) {
    return std::max(length(a.origin - b.origin), 100.0 * length(a.direction - b.direction));
}

/// The rounding error to expect of a traced ray, mm, and 100 mm times that of its direction: at each surface the point
/// is wrong by 2 ulp of 100 mm and the direction by 2 ulp, and the surfaces behind it amplify that by what they do to
/// a ray that is off by 1e-7 mm, or 1e-7, there.
double rounding_error(const TraceLens<double>& lens, const Ray<double>& ray) {
    constexpr double kStep = 1e-7;
    double sum = 0.0;
    const auto amplified = [&](const Ray<double>& from, std::size_t next) {
        const TraceLens<double> rest{
            .surfaces = {lens.surfaces.begin() + static_cast<std::ptrdiff_t>(next), lens.surfaces.end()},
            .image_z = lens.image_z,
            .specials = lens.specials};
        const auto arrives = [&](const Ray<double>& r) {
            return image_ray(rest, trace<Direction::forward, Rims::follow>(rest, r));
        };
        const Ray<double> exact = arrives(from);
        for (const Vec3d axis : {Vec3d{1.0, 0.0, 0.0}, Vec3d{0.0, 1.0, 0.0}}) {
            const Ray<double> shifted{from.origin + kStep * axis, from.direction};
            const Ray<double> turned{from.origin, normalized(from.direction + kStep * axis)};
            sum += 2.0 * kEpsilon / kStep * (100.0 * apart(arrives(shifted), exact) + apart(arrives(turned), exact));
        }
    };
    amplified(ray, 0);
    trace(lens, ray, [&](const SurfaceEvent<double>& event) {
        amplified(event.ray, static_cast<std::size_t>(event.surface) + 1);
    });
    return sum;
}

/// Calls check(lens, ray, traced) with rays that pass every rim, of random lenses.
template <class Check>
void for_random_rays(std::uint64_t seed, Check&& check) {
    RandomLenses random(seed);
    int passed = 0;
    for (int i = 0; i < kLenses; ++i) {
        const Prescription prescription = random.next();
        const TraceLens<double> lens = traced_lens<double>(prescription);
        for (int k = 0; k < kRaysOfALens; ++k) {
            const Ray<double> ray = random_ray(random, lens);
            const TracedRay<double> traced = trace(lens, ray);
            if (traced.status == RayStatus::ok) {
                SCOPED_TRACE(testing::Message() << "lens " << i << " ray " << k);
                check(prescription, lens, ray, traced);
                ++passed;
            }
        }
    }
    EXPECT_GT(passed, kLenses * kRaysOfALens / 10);
}

// Light finds the same path back: from the image plane in reverse to the plane that it came from, to 1e-10 mm, with the
// same optical path, direction and (reciprocity of Fresnel's equations) transmittance.
TEST(AnyLens, LightFindsItsWayBack) {
    for_random_rays(1, [](const Prescription&, const TraceLens<double>& lens, const Ray<double>& ray,
                          const TracedRay<double>& out) {
        const Ray<double> image = image_ray(lens, out);
        const TracedRay<double> back =
            trace<Direction::reverse>(lens, Ray<double>{image.origin, -1.0 * image.direction});
        ASSERT_EQ(back.status, RayStatus::ok);
        const PlanePoint<double> start = meet_plane(back.ray, ray.origin.z);
        EXPECT_LT(length(start.point - ray.origin), 1e-10);
        EXPECT_LT(length(back.ray.direction + ray.direction), 1e-12);
        const double forward_path = out.optical_path + meet_plane(out.ray, lens.image_z).distance;
        EXPECT_NEAR(back.optical_path + start.distance, forward_path, 1e-10);
        EXPECT_NEAR(back.transmittance, out.transmittance, 1e-12);
    });
}

/// (x, y, n L, n M) in a plane: coordinates in which refraction and transfer are canonical (Hamilton).
using Phase = std::array<long double, 4>;

/// The image plane's phase as a function of that at the plane of `ray`'s origin, in air on both sides.
Phase through(const TraceLens<long double>& lens, const Ray<long double>& ray, const Phase& step) {
    const long double l = ray.direction.x + step[2];
    const long double m = ray.direction.y + step[3];
    const Ray<long double> moved{{ray.origin.x + step[0], ray.origin.y + step[1], ray.origin.z},
                                 {l, m, std::sqrt(1.0L - l * l - m * m)}};
    const Ray<long double> image = image_ray(lens, trace<Direction::forward, Rims::follow>(lens, moved));
    return {image.origin.x, image.origin.y, image.direction.x, image.direction.y};
}

struct Jacobian {
    std::array<Phase, 4> columns{};
    long double largest = 1.0L;  // of its elements, without sign
    long double error = 0.0L;    // of an element
};

/// Columns by differences of eighth order, with steps of 1e-3 mm and 1e-4 in direction. Their error is taken as their
/// distance from the differences of sixth order, which err more, and 1e-15 of the largest element for rounding: 1e-19 /
/// 1e-4, as the lens amplifies it. (Where a ray is close to the critical angle the map bends sharply and the error is
/// large.)
Jacobian jacobian(const TraceLens<long double>& lens, const Ray<long double>& ray) {
    struct Stencil {
        long double multiple, sixth, eighth;
    };
    constexpr std::array<Stencil, 4> kStencils = {{{1.0L, 3.0L / 4.0L, 4.0L / 5.0L},
                                                   {2.0L, -3.0L / 20.0L, -1.0L / 5.0L},
                                                   {3.0L, 1.0L / 60.0L, 4.0L / 105.0L},
                                                   {4.0L, 0.0L, -1.0L / 280.0L}}};
    Jacobian result;
    std::array<Phase, 4> distance{};
    for (std::size_t k = 0; k < 4; ++k) {
        const long double h = k < 2 ? 1e-3L : 1e-4L;
        for (const Stencil& stencil : kStencils) {
            Phase step{};
            step[k] = stencil.multiple * h;
            const Phase ahead = through(lens, ray, step);
            step[k] = -stencil.multiple * h;
            const Phase behind = through(lens, ray, step);
            for (std::size_t i = 0; i < 4; ++i) {
                const long double slope = (ahead[i] - behind[i]) / h;
                result.columns[k][i] += stencil.eighth * slope;
                distance[k][i] += (stencil.eighth - stencil.sixth) * slope;
            }
        }
        for (std::size_t i = 0; i < 4; ++i) {
            result.largest = std::max(result.largest, std::abs(result.columns[k][i]));
            result.error = std::max(result.error, std::abs(distance[k][i]));
        }
    }
    result.error += 1e-15L * result.largest;
    return result;
}

/// The Lagrange invariant of two rays close to one ray.
long double invariant(const Phase& a, const Phase& b) {
    return a[0] * b[2] - a[2] * b[0] + a[1] * b[3] - a[3] * b[1];
}

// Étendue dx dy d(nL) d(nM) is the same in front of a lens and behind it, around every real ray: the Jacobian has
// determinant 1. More than that, it is symplectic: the Lagrange invariant of any two rays close to a third is
// conserved, of which the paraxial one is the case on the axis (Welford, Aberrations of Optical Systems, §5.5; Born &
// Wolf 4.8).
TEST(AnyLens, EtendueAndLagrangeInvariantsAreConservedAroundRealRays) {
    for_random_rays(2, [count = 0](const Prescription& prescription, const TraceLens<double>&, const Ray<double>& ray,
                                   const TracedRay<double>&) mutable {
        if (++count % 4 != 0) {
            return;  // 32 rays traced for each
        }
        const TraceLens<long double> lens = traced_lens<long double>(prescription);
        const auto [columns, largest, error] =
            jacobian(lens, {convert_vector<long double>(ray.origin), convert_vector<long double>(ray.direction)});
        EXPECT_NEAR(Eigen::Map<const Eigen::Matrix4<long double>>(columns[0].data()).determinant(), 1.0L,
                    4.0L * error * largest);
        for (std::size_t a = 0; a < 4; ++a) {
            for (std::size_t b = a + 1; b < 4; ++b) {
                EXPECT_NEAR(invariant(columns[a], columns[b]), b == a + 2 ? 1.0L : 0.0L, 8.0L * error * largest);
            }
        }
    });
}

// The skewness n (x M − y L) of a ray is the same before and after every surface of revolution (Welford §5.3), to the
// rounding of each surface: 16 ulp of numbers of size 100 mm.
TEST(AnyLens, SkewnessIsConserved) {
    for_random_rays(
        3, [](const Prescription&, const TraceLens<double>& lens, const Ray<double>& ray, const TracedRay<double>&) {
            const auto skewness = [](const Ray<double>& r) { return cross(r.origin, r.direction).z; };
            const double before = skewness(ray);
            trace(lens, ray, [&](const SurfaceEvent<double>& event) {
                const double n = lens.surfaces[static_cast<std::size_t>(event.surface)].index_after;
                EXPECT_NEAR(n * skewness(event.ray), before, 16.0 * kEpsilon * 100.0 * (event.surface + 2));
            });
        });
}

// The optical sine theorem (Kingslake & Johnson, Lens Design Fundamentals, §9.4): any zone of any lens of revolution
// images a short sagittal line at an axial point with the magnification n sin U / (n' sin U'). The ray from the line's
// end is followed to where it crosses the meridional plane x–z; there x' sin U' = x sin U up to the square of x.
TEST(AnyLens, SagittalImagesObeyTheOpticalSineTheorem) {
    RandomLenses random(4);
    int passed = 0;
    for (int i = 0; i < kLenses; ++i) {
        const TraceLens<long double> lens = traced_lens<long double>(random.next());
        for (const double sine : {0.02, 0.05, 0.1, 0.15, 0.2}) {
            const auto sin_u = static_cast<long double>(sine);
            const Vec3<long double> direction{0.0L, sin_u, std::sqrt(1.0L - sin_u * sin_u)};
            constexpr long double kHeight = 1e-6L;
            const TracedRay<long double> zone = trace(lens, Ray<long double>{{0.0L, 0.0L, -40.0L}, direction});
            const TracedRay<long double> beside = trace(lens, Ray<long double>{{kHeight, 0.0L, -40.0L}, direction});
            if (zone.status != RayStatus::ok || beside.status != RayStatus::ok) {
                continue;
            }
            const Ray<long double>& out = beside.ray;
            const long double image_height = out.origin.x - out.origin.y / out.direction.y * out.direction.x;
            // Derivatives of the map over 10 mm: (1e-6 / 10)², and the rounding 1e-19 · 100 mm / 1e-6 mm, both as
            // amplified where a ray nearly meets the axis far away.
            const long double far = 1.0L + std::abs(out.origin.y / out.direction.y) / 10.0L;
            EXPECT_NEAR(image_height * zone.ray.direction.y / (kHeight * sin_u), 1.0L, 1e-10L * far * far);
            ++passed;
        }
    }
    EXPECT_GT(passed, kLenses);
}

// Abbe's sine condition holds without any limit for the aplanatic points of a sphere: sin U' = n sin U for every ray
// that converges in air on the point R (1 + n) behind the vertex of a sphere of glass n (Born & Wolf 4.2.3).
TEST(AnyLens, AplanaticPointsObeyAbbesSineCondition) {
    constexpr double kRadius = 20.0;
    for (const double n : {1.3, 1.5, 1.9, 3.0}) {
        TraceLens<double> sphere{.surfaces = {make_trace_surface(1.0 / kRadius, 0.0, kRadius, 1.0, n, false)},
                                 .image_z = 100.0};
        for (const double height : {0.1, 5.0, 12.0, 19.0}) {
            const double on_sphere_z = kRadius - std::sqrt(kRadius * kRadius - height * height);
            const Vec3d on_sphere{0.0, height, on_sphere_z};
            const Vec3d direction = normalized(Vec3d{0.0, 0.0, kRadius * (1.0 + n)} - on_sphere);
            const TracedRay<double> out = trace(sphere, Ray<double>{on_sphere - 30.0 * direction, direction});
            ASSERT_EQ(out.status, RayStatus::ok);
            // Both sines are height / 20 mm or more, and off by some roundings of numbers of size 1.
            EXPECT_NEAR(out.ray.direction.y / direction.y, n, 40.0 * kEpsilon * kRadius / height * n);
        }
    }
}

Prescription scaled(Prescription lens, double s) {
    for (PrescribedSurface& surface : lens.surfaces) {
        surface.radius_mm *= s;
        surface.thickness_mm *= s;
        *surface.semi_diameter_mm *= s;
        for (int i = 0; i < kAsphereTerms; ++i) {
            surface.asphere[i] *= std::pow(s, 1 - 2 * (i + 1));
        }
    }
    return lens;
}

// A lens s times as large does the same to rays s times as far out. For a power of two every number is the same but for
// its exponent, so that without Newton's method (whose end is judged in mm) all bits agree.
TEST(AnyLens, ScalingChangesNothing) {
    for_random_rays(5, [](const Prescription& prescription, const TraceLens<double>& lens, const Ray<double>& ray,
                          const TracedRay<double>& out) {
        const Ray<double> image = image_ray(lens, out);
        const bool has_asphere = std::ranges::any_of(prescription.surfaces, &PrescribedSurface::is_asphere);
        for (const double s : {4.0, 0.37}) {
            const TraceLens<double> larger = traced_lens<double>(scaled(prescription, s));
            const TracedRay<double> other = trace(larger, Ray<double>{s * ray.origin, ray.direction});
            ASSERT_EQ(other.status, RayStatus::ok);
            const Ray<double> other_image = image_ray(larger, other);
            if (s == 4.0 && !has_asphere) {
                EXPECT_EQ(other_image.origin, s * image.origin);
                EXPECT_EQ(other_image.direction, image.direction);
                EXPECT_EQ(other.transmittance, out.transmittance);
            }
            EXPECT_LT(apart({1.0 / s * other_image.origin, other_image.direction}, image), rounding_error(lens, ray));
        }
    });
}

// Turning ray and all about the axis is the same as turning the ray that arrives.
TEST(AnyLens, TurningAboutTheAxisChangesNothing) {
    for_random_rays(6, [](const Prescription&, const TraceLens<double>& lens, const Ray<double>& ray,
                          const TracedRay<double>& out) {
        const Ray<double> image = image_ray(lens, out);
        for (const double angle : {0.3, 1.9, -2.5}) {
            const auto turned = [&](const Vec3d& v) {
                return Vec3d{std::cos(angle) * v.x - std::sin(angle) * v.y,
                             std::sin(angle) * v.x + std::cos(angle) * v.y, v.z};
            };
            const TracedRay<double> other = trace(lens, Ray<double>{turned(ray.origin), turned(ray.direction)});
            ASSERT_EQ(other.status, RayStatus::ok);
            EXPECT_LT(apart(image_ray(lens, other), {turned(image.origin), turned(image.direction)}),
                      rounding_error(lens, ray));
            EXPECT_NEAR(other.transmittance, out.transmittance, 1e-12);
        }
    });
}

// The mirror image in x (or y) of a ray has the same numbers with another sign: all bits agree.
TEST(AnyLens, IsSymmetricInX) {
    for_random_rays(7, [](const Prescription&, const TraceLens<double>& lens, const Ray<double>& ray,
                          const TracedRay<double>& out) {
        for (const Vec2d sign : {Vec2d{-1.0, 1.0}, Vec2d{1.0, -1.0}}) {
            const auto mirrored = [&](const Vec3d& v) { return Vec3d{sign.x * v.x, sign.y * v.y, v.z}; };
            const TracedRay<double> other = trace(lens, Ray<double>{mirrored(ray.origin), mirrored(ray.direction)});
            EXPECT_EQ(other.status, out.status);
            EXPECT_EQ(other.ray.origin, mirrored(out.ray.origin));
            EXPECT_EQ(other.ray.direction, mirrored(out.ray.direction));
            EXPECT_EQ(other.optical_path, out.optical_path);
            EXPECT_EQ(other.transmittance, out.transmittance);
        }
    });
}

/// The lens with a surface that changes no medium at `fraction` of the gap behind surface i.
Prescription split(Prescription lens, std::size_t i, double fraction, double radius_mm) {
    PrescribedSurface dummy;
    dummy.radius_mm = radius_mm;
    dummy.semi_diameter_mm = 1e3;
    dummy.medium = lens.surfaces[i].medium;
    dummy.thickness_mm = (1.0 - fraction) * lens.surfaces[i].thickness_mm;
    lens.surfaces[i].thickness_mm *= fraction;
    lens.surfaces.insert(lens.surfaces.begin() + static_cast<std::ptrdiff_t>(i) + 1, dummy);
    return lens;
}

// A surface between equal media, flat or bent, in air or in glass, reflects nothing and bends nothing. Its own rounding
// is one surface's more, where the allowance counts each twice (this ray's and the other's).
TEST(AnyLens, SplittingAGapChangesNothing) {
    for_random_rays(8, [count = std::size_t{0}](const Prescription& prescription, const TraceLens<double>& lens,
                                                const Ray<double>& ray, const TracedRay<double>& out) mutable {
        const std::size_t gap = count++ % (prescription.surfaces.size() - 1);
        for (const double radius : {kInfinity, 2000.0, -3000.0}) {
            const TraceLens<double> longer = traced_lens<double>(split(prescription, gap, 0.4, radius));
            const TracedRay<double> other = trace(longer, ray);
            ASSERT_EQ(other.status, RayStatus::ok);
            const double tolerance = 2.0 * rounding_error(lens, ray);
            EXPECT_LT(apart(image_ray(longer, other), image_ray(lens, out)), tolerance);
            EXPECT_NEAR(other.optical_path, out.optical_path, tolerance);
            EXPECT_NEAR(other.transmittance, out.transmittance, 1e-12);
        }
    });
}

}  // namespace lensproof::optics::trace_property_test
