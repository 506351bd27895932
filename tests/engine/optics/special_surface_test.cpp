// Surfaces that are more than a centred sphere, against closed forms and against other ways of saying the same surface.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "engine/base/angle.h"
#include "engine/base/infinity.h"
#include "engine/formats/glass/shipped_glasses.h"
#include "engine/optics/convert_lens.h"
#include "engine/optics/focus.h"
#include "engine/optics/lens.h"
#include "engine/optics/multiprecision.h"
#include "engine/optics/paraxial.h"
#include "engine/optics/surface_curvature.h"
#include "engine/spectral/wavelengths.h"

namespace lensproof::optics::special_surface_test {

constexpr double kUlp = std::numeric_limits<double>::epsilon();
constexpr double kWavelength = 587.5618;
constexpr double kFlat = kInfinity;

PrescribedSurface row(double radius_mm, double thickness_mm, double n_d = 1.0, double semi_diameter_mm = 50.0) {
    return {.radius_mm = radius_mm,
            .thickness_mm = thickness_mm,
            .semi_diameter_mm = semi_diameter_mm,
            .medium = n_d == 1.0 ? StatedMedium{} : StatedMedium{.n_d = n_d}};
}

PrescribedSurface stop_row(double thickness_mm, double semi_diameter_mm = 50.0) {
    PrescribedSurface surface = row(kFlat, thickness_mm, 1.0, semi_diameter_mm);
    surface.is_stop = true;
    return surface;
}

Prescription prescription_of(std::vector<PrescribedSurface> surfaces) {
    return {.name = "test", .surfaces = std::move(surfaces)};
}

TraceLens<double> traceable(const Prescription& prescription) {
    return at_wavelength<double>(make_lens(prescription, GlassCatalogue{}), kWavelength);
}

/// Glass of that front, and a stop behind it.
TraceLens<double> glass_behind(const PrescribedSurface& front, double rear_radius_mm = kFlat) {
    return traceable(prescription_of({front, row(rear_radius_mm, 2.0), stop_row(50.0)}));
}

/// A biconvex lens with a stop behind it.
Prescription biconvex(double n_d = 1.6, double stop_semi_diameter_mm = 20.0) {
    return prescription_of({row(40.0, 6.0, n_d), row(-60.0, 3.0), stop_row(50.0, stop_semi_diameter_mm)});
}

/// Rays from all around: heights up to `height`, slopes up to `slope`, from z = −20.
std::vector<Ray<double>> rays(double height, double slope, int count = 200) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    std::vector<Ray<double>> made;
    for (int i = 0; i < count; ++i) {
        const Vec3d direction = normalized(Vec3d{slope * unit(random), slope * unit(random), 1.0});
        const Vec3d at_vertex{height * unit(random), height * unit(random), 0.0};
        made.push_back({at_vertex + (-20.0 / direction.z) * direction, direction});
    }
    return made;
}

void expect_same_rays(const TraceLens<double>& a, const TraceLens<double>& b, const std::vector<Ray<double>>& bundle,
                      double tolerance) {
    int passed = 0;
    for (const Ray<double>& ray : bundle) {
        const TracedRay<double> through_a = trace(a, ray);
        const TracedRay<double> through_b = trace(b, ray);
        ASSERT_EQ(through_a.status, through_b.status);
        if (through_a.status == RayStatus::ok) {
            ++passed;
            EXPECT_LT(length(through_a.ray.origin - through_b.ray.origin), tolerance);
            EXPECT_LT(length(through_a.ray.direction - through_b.ray.direction), tolerance);
            EXPECT_NEAR(through_a.optical_path, through_b.optical_path, tolerance);
            EXPECT_NEAR(through_a.transmittance, through_b.transmittance, tolerance);
        }
    }
    EXPECT_GT(passed, static_cast<int>(bundle.size()) / 2);
}

// An ellipsoid of eccentricity 1/n, k = −1/n², images infinity from air into glass without aberration, a distance
// n R / (n − 1) behind its vertex (Born & Wolf, §4.2). Ten operations on numbers of that size.
TEST(Conic, EllipsoidHasAPerfectFocus) {
    constexpr double n = 1.6;
    constexpr double R = 30.0;
    constexpr double kFocus = n * R / (n - 1.0);
    PrescribedSurface front = row(R, kFocus, n, 20.0);
    front.conic = -1.0 / (n * n);
    const TraceLens<double> lens = traceable(prescription_of({stop_row(5.0), front, row(kFlat, 1.0)}));
    for (const double height : {0.0, 0.001, 5.0, 12.0, 19.9}) {
        const TracedRay<double> traced =
            trace<Direction::forward>(lens, Ray<double>{{0.6 * height, 0.8 * height, -9.0}, {0.0, 0.0, 1.0}});
        ASSERT_EQ(traced.status, RayStatus::ok) << height;
        EXPECT_NEAR(traced.ray.origin.x, 0.0, 20 * kUlp * kFocus) << height;
        EXPECT_NEAR(traced.ray.origin.y, 0.0, 20 * kUlp * kFocus) << height;
        // Malus and Dupin: all paths to the focus are optically as long.
        EXPECT_NEAR(traced.optical_path, 9.0 + 5.0 + n * kFocus, 40 * kUlp * kFocus * n) << height;
    }
}

// A hyperboloid, k = −n², does the same from glass into air, R / (n − 1) behind its vertex for a flat front.
TEST(Conic, HyperboloidHasAPerfectFocus) {
    constexpr double n = 1.5;
    constexpr double R = 25.0;
    PrescribedSurface rear = row(-R, R / (n - 1.0));
    rear.conic = -n * n;
    const TraceLens<double> lens = traceable(prescription_of({stop_row(1.0), row(kFlat, 12.0, n), rear}));
    for (const double height : {0.0, 0.1, 3.0, 10.0, 20.0}) {
        const TracedRay<double> traced = trace(lens, Ray<double>{{height, 0.0, -9.0}, {0.0, 0.0, 1.0}});
        ASSERT_EQ(traced.status, RayStatus::ok);
        EXPECT_NEAR(meet_plane(traced.ray, lens.image_z).point.x, 0.0, 100 * kUlp * 50.0) << height;
    }
}

// A paraboloid z = r² / 2R is a conic of k = −1, and an even asphere without curvature whose r² term is 1 / 2R: the
// quadratic and Newton's method have to find the same points. Newton stops within 16 ulp of the path.
TEST(Asphere, NewtonFindsWhatTheQuadraticFinds) {
    constexpr double R = 30.0;
    PrescribedSurface conic = row(R, 6.0, 1.7);
    conic.conic = -1.0;
    PrescribedSurface polynomial = row(kFlat, 6.0, 1.7);
    polynomial.asphere[0] = 0.5 / R;
    expect_same_rays(glass_behind(conic, -80.0), glass_behind(polynomial, -80.0), rays(15.0, 0.8), 1e-12);
    EXPECT_NEAR(paraxial_data(glass_behind(conic, -80.0)).efl, paraxial_data(glass_behind(polynomial, -80.0)).efl,
                1e-12);
}

// The sphere's own series, r² / 2R + r⁴ / 8R³ + …, to r²⁰: what is left out is below (r/2R)²² R.
TEST(Asphere, SeriesOfASphereIsTheSphere) {
    constexpr double R = 40.0;
    PrescribedSurface series = row(kFlat, 6.0, 1.6);
    double coefficient = 0.5 / R;
    for (int i = 0; i < kAsphereTerms; ++i) {
        series.asphere[i] = coefficient;
        coefficient *= (2.0 * i + 1.0) / (2.0 * i + 4.0) / (R * R);
    }
    expect_same_rays(glass_behind(row(R, 6.0, 1.6), -80.0), glass_behind(series, -80.0), rays(8.0, 0.3), 1e-11);
}

// Terms that cancel: their sum is known to an ulp of the largest, 200 mm here, while the surface departs from its base
// by little. Every ray that meets the base meets it.
TEST(Asphere, TermsThatCancelAreMetAllTheSame) {
    PrescribedSurface front = row(60.0, 8.0, 1.7, 14.0);
    const double r2 = 12.0 * 12.0;
    // 200 mm (r/12)⁴ (1 − (r/12)²)… up to r²⁰ in signs that alternate: (1 − u)⁸ u² has a maximum of 0.007 at u = 1/5.
    constexpr std::array kBinomials = {1.0, -8.0, 28.0, -56.0, 70.0, -56.0, 28.0, -8.0, 1.0};
    for (int i = 0; i < 9; ++i) {
        front.asphere[i + 1] = 2.8 * kBinomials[i] / std::pow(r2, i + 2);
    }
    const TraceLens<double> lens = glass_behind(front);
    int missed = 0;
    for (const Ray<double>& ray : rays(7.0, 0.4, 2000)) {
        missed += trace<Direction::forward, Rims::follow>(lens, ray).status == RayStatus::missed ? 1 : 0;
    }
    EXPECT_EQ(missed, 0);
}

TEST(Asphere, PointsLieOnTheSurfaceAndBackTheRayReturns) {
    PrescribedSurface front = row(28.0, 8.0, 1.7, 14.0);
    front.conic = -0.7;
    front.asphere = {0.0, 2e-5, -3e-8, 4e-11, -1e-13};
    const TraceLens<double> lens = glass_behind(front, -60.0);
    const SurfaceShape<double>& shape = lens.specials.front().shape;
    for (const Ray<double>& ray : rays(9.0, 0.5)) {
        Vec3d met{};
        const TracedRay<double> out = trace(lens, ray, [&](const SurfaceEvent<double>& event) {
            if (event.surface == 0) {
                met = event.ray.origin;
            }
        });
        EXPECT_NEAR(met.z, sag(shape, met.x, met.y), 1e-13);
        if (out.status == RayStatus::ok) {
            const TracedRay<double> back =
                trace<Direction::reverse>(lens, Ray<double>{out.ray.origin, -1.0 * out.ray.direction});
            ASSERT_EQ(back.status, RayStatus::ok);
            EXPECT_LT(length(cross(back.ray.origin - ray.origin, ray.direction)), 1e-11);
            EXPECT_LT(length(back.ray.direction + ray.direction), 1e-12);
        }
    }
}

// A cone of glass turns every ray along the axis by the same angle, asin(n sin α) − α towards the axis, α the angle
// between its faces (McLeod, "The axicon", J. Opt. Soc. Am. 44, 592, 1954). Its first-order data are a plate's.
TEST(OddAsphere, ConeTurnsRaysByOneAngle) {
    constexpr double n = 1.5;
    const double alpha = 12.0 * kDegree;
    PrescribedSurface cone = row(kFlat, 40.0);
    cone.term(1) = -std::tan(alpha);
    const TraceLens<double> lens = traceable(prescription_of({stop_row(1.0), row(kFlat, 8.0, n), cone}));
    for (const double height : {1e-9, 0.001, 1.0, 5.0, 20.0}) {
        const TracedRay<double> out = trace(lens, Ray<double>{{0.6 * height, 0.8 * height, -5.0}, {0.0, 0.0, 1.0}});
        ASSERT_EQ(out.status, RayStatus::ok) << height;
        const double turned = std::asin(n * std::sin(alpha)) - alpha;
        EXPECT_NEAR(out.ray.direction.x, -0.6 * std::sin(turned), 8 * kUlp) << height;
        EXPECT_NEAR(out.ray.direction.y, -0.8 * std::sin(turned), 8 * kUlp) << height;
    }
    const TracedRay<double> at_tip = trace(lens, Ray<double>{{0.0, 0.0, -5.0}, {0.0, 0.0, 1.0}});
    EXPECT_EQ(at_tip.status, RayStatus::ok);
    EXPECT_EQ(at_tip.ray.direction, (Vec3d{0.0, 0.0, 1.0}));
    EXPECT_TRUE(std::isinf(paraxial_data(lens).efl));
}

/// Every power from r to r²⁰, up to 0.1 mm each at 9 mm.
PrescribedSurface every_power() {
    PrescribedSurface front = row(28.0, 8.0, 1.7, 14.0);
    front.conic = -0.7;
    for (int power = 1; power <= kHighestPower; ++power) {
        front.term(power) = (power % 3 == 0 ? -0.1 : 0.07) / std::pow(9.0, power);
    }
    return front;
}

/// The sag by powers, in a hundred digits.
Multiprecision sag_by_powers(const PrescribedSurface& row, const Multiprecision& x, const Multiprecision& y) {
    const Multiprecision c = row.curvature();
    const Multiprecision r = sqrt(x * x + y * y);
    const Multiprecision k = row.conic;
    const Multiprecision root = sqrt(1 - (1 + k) * c * c * r * r);
    Multiprecision terms = 0;
    for (int power = 1; power <= kHighestPower; ++power) {
        terms += row.term(power) * pow(r, power);
    }
    const Multiprecision slope = c * r / root;  // of the conic: 1 / cos is √(1 + slope²)
    return c * r * r / (1 + root) + (row.along_normal ? sqrt(1 + slope * slope) : Multiprecision(1)) * terms;
}

// Against differences of the sag in a hundred digits: by 1e-25 mm, whose remainder is some 1e-50. The profile's 30
// operations on numbers up to 2 mm.
class EveryPower : public testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(AlongAxisAndNormal, EveryPower, testing::Bool());

TEST_P(EveryPower, SlopesAndCurvaturesAreThoseOfTheSag) {
    PrescribedSurface front = every_power();
    front.along_normal = GetParam();
    const SurfaceShape<double> shape = prescribed_shape(front);
    const Multiprecision h("1e-25");
    for (const double x : {0.0, 1e-3, -0.4, 3.0, 8.0}) {
        for (const double y : {1e-4, 0.3, -4.0}) {
            const auto at = [&](int i, int k) { return sag_by_powers(front, x + i * h, y + k * h); };
            const double z = static_cast<double>(at(0, 0));
            EXPECT_NEAR(sag(shape, x, y), z, 30 * kUlp);
            const SurfaceDerivatives<double> derivatives = surface_derivatives(shape, {x, y, z});
            const auto& [gradient, hessian] = derivatives;
            // The cone's part of a curvature is A1 / r in one direction, and in the other that cancels.
            const double largest = 1.0 + front.term(1) / std::hypot(x, y);
            const auto expect = [&](double found, const Multiprecision& difference) {
                EXPECT_NEAR(found, static_cast<double>(difference), 30 * kUlp * largest);
            };
            expect(-gradient.x, (at(1, 0) - at(-1, 0)) / (2 * h));
            expect(-gradient.y, (at(0, 1) - at(0, -1)) / (2 * h));
            expect(-hessian[0].x, (at(1, 0) - 2 * at(0, 0) + at(-1, 0)) / (h * h));
            expect(-hessian[1].y, (at(0, 1) - 2 * at(0, 0) + at(0, -1)) / (h * h));
            expect(-hessian[0].y, (at(1, 1) - at(1, -1) - at(-1, 1) + at(-1, -1)) / (4 * h * h));
        }
    }
}

// Rays in double and in a hundred digits, whose sag is held to powers of r in the test above.
TEST_P(EveryPower, RaysAreThoseOfAHundredDigits) {
    PrescribedSurface front = every_power();
    front.along_normal = GetParam();
    const TraceLens<double> lens = glass_behind(front, -60.0);
    const TraceLens<Multiprecision> exact = convert_lens<Multiprecision>(lens);
    int passed = 0;
    for (const Ray<double>& ray : rays(7.0, 0.4)) {
        const TracedRay<double> out = trace(lens, ray);
        const TracedRay<Multiprecision> as_exact = trace(exact, convert_ray<Multiprecision>(ray));
        ASSERT_EQ(out.status, as_exact.status);
        if (out.status == RayStatus::ok) {
            ++passed;
            EXPECT_LT(length(out.ray.origin - convert_vector<double>(as_exact.ray.origin)), 1e-12);
            EXPECT_LT(length(out.ray.direction - convert_vector<double>(as_exact.ray.direction)), 1e-13);
            EXPECT_NEAR(out.optical_path, static_cast<double>(as_exact.optical_path), 1e-12);
        }
    }
    EXPECT_GT(passed, 100);
}

// A ray past the equator of the conic, or towards a part that turns away, has a status and finite numbers.
TEST(Asphere, MissesAreStatuses) {
    PrescribedSurface front = row(10.0, 8.0, 1.7, 14.0);
    front.asphere[1] = 1e-6;
    const TraceLens<double> lens = glass_behind(front);
    for (const Ray<double>& ray : rays(30.0, 5.0, 2000)) {
        const TracedRay<double> out = trace<Direction::forward, Rims::follow>(lens, ray);
        EXPECT_TRUE(std::isfinite(out.ray.origin.x + out.ray.origin.y + out.ray.origin.z + out.optical_path));
    }
}

// Equal radii in both sections make the toroid a sphere; an infinite one makes it a cylinder, which is a sphere to rays
// in y–z and a plate to rays in x–z.
TEST(Toroid, IsASphereOrACylinderAtItsEnds) {
    PrescribedSurface toroid = row(35.0, 6.0, 1.6);
    toroid.radius_x_mm = 35.0;
    expect_same_rays(glass_behind(row(35.0, 6.0, 1.6)), glass_behind(toroid), rays(15.0, 0.5), 1e-12);

    PrescribedSurface cylinder = row(35.0, 6.0, 1.6);
    cylinder.radius_x_mm = kFlat;
    std::vector<Ray<double>> meridional = rays(15.0, 0.5);
    std::vector<Ray<double>> sagittal = meridional;
    for (std::size_t i = 0; i < meridional.size(); ++i) {
        const auto in_plane = [](const Ray<double>& ray, double x, double y) {
            return Ray<double>{{x * ray.origin.x, y * ray.origin.y, ray.origin.z},
                               normalized(Vec3d{x * ray.direction.x, y * ray.direction.y, ray.direction.z})};
        };
        sagittal[i] = in_plane(meridional[i], 1.0, 0.0);
        meridional[i] = in_plane(meridional[i], 0.0, 1.0);
    }
    expect_same_rays(glass_behind(row(35.0, 6.0, 1.6)), glass_behind(cylinder), meridional, 1e-12);
    expect_same_rays(glass_behind(row(kFlat, 6.0, 1.6)), glass_behind(cylinder), sagittal, 1e-12);
}

// Turning a whole lens about a point is turning the ray the other way.
TEST(Misalignment, TurningTheLensIsTurningTheRay) {
    Prescription straight = biconvex();
    Prescription turned = straight;
    constexpr double kTilt = 7.0;
    constexpr double kPivot = 4.0;
    turned.groups = {{.first = 1,
                      .last = 3,
                      .misalignment = {.decentre_mm = {0.3, -0.2}, .tilt_deg = {kTilt, 0.0, 0.0}},
                      .pivot_mm = kPivot}};
    const TraceLens<double> lens = traceable(straight);
    const TraceLens<double> turned_lens = traceable(turned);
    const double sine = std::sin(radians(kTilt));
    const double cosine = std::cos(radians(kTilt));
    // Right-handed about x: y turns towards z.
    const auto rotate = [&](const Vec3d& v) {
        return Vec3d{v.x, cosine * v.y - sine * v.z, sine * v.y + cosine * v.z};
    };
    const auto place = [&](const Vec3d& v) { return rotate(v - Vec3d{0.0, 0.0, kPivot}) + Vec3d{0.3, -0.2, kPivot}; };
    for (const Ray<double>& ray : rays(10.0, 0.3)) {
        const TracedRay<double> before = trace(lens, ray);
        const TracedRay<double> after = trace(turned_lens, Ray<double>{place(ray.origin), rotate(ray.direction)});
        ASSERT_EQ(before.status, after.status);
        if (before.status == RayStatus::ok) {
            EXPECT_LT(length(place(before.ray.origin) - after.ray.origin), 1e-12);
            EXPECT_LT(length(rotate(before.ray.direction) - after.ray.direction), 1e-13);
        }
    }
}

// A surface's own tilt about its vertex is that of a group of one.
TEST(Misalignment, OfOneSurfaceIsThatOfItsGroup) {
    const Misalignment misalignment{.decentre_mm = {0.5, 1.0}, .tilt_deg = {3.0, -4.0, 20.0}};
    Prescription own = biconvex();
    Prescription grouped = own;
    own.surfaces[1].misalignment = misalignment;
    grouped.groups = {{.first = 2, .last = 2, .misalignment = misalignment}};
    expect_same_rays(traceable(own), traceable(grouped), rays(10.0, 0.3), 1e-13);
}

TEST(Coating, IsTracedFromThePrescriptionBothWays) {
    Prescription prescription = biconvex();
    prescription.coatings["v"] =
        LayerStack{{{.index = {{550.0, std::sqrt(1.6)}}, .thickness_nm = kWavelength / 4.0 / std::sqrt(1.6)}}};
    prescription.coatings["stated"] = std::vector<WavelengthValue>{{500.0, 0.01}, {700.0, 0.03}};
    prescription.surfaces[0].coating = "v";
    prescription.surfaces[1].coating = "stated";
    const TraceLens<double> lens = traceable(prescription);
    const TracedRay<double> forwards = trace(lens, Ray<double>{{0.0, 0.0, -5.0}, {0.0, 0.0, 1.0}});
    const double stated = 1.0 - interpolated({{500.0, 0.01}, {700.0, 0.03}}, kWavelength);
    EXPECT_NEAR(forwards.transmittance, stated, 1e-14);
    EXPECT_NEAR(stated, 1.0 - (0.01 + 0.02 * 87.5618 / 200.0), 1e-15);
    const TracedRay<double> back = trace<Direction::reverse>(lens, Ray<double>{{0.0, 0.0, 60.0}, {0.0, 0.0, -1.0}});
    EXPECT_NEAR(back.transmittance, stated, 1e-14);
}

/// The fraction of the stop's circle that a mask lets through, on a grid: its error is that of the cells at the edge,
/// perimeter / cell = 2π·400 of 4·10⁵, random in sign.
double mask_transmittance(const StopMask& mask) {
    constexpr int kCells = 800;
    double open = 0.0;
    int inside = 0;
    for (int i = 0; i < kCells; ++i) {
        for (int k = 0; k < kCells; ++k) {
            const double x = 2.0 * (i + 0.5) / kCells - 1.0;
            const double y = 2.0 * (k + 0.5) / kCells - 1.0;
            if (x * x + y * y <= 1.0) {
                ++inside;
                open += mask.transmittance(x, y);
            }
        }
    }
    return open / inside;
}

// A regular polygon fills N sin(2π/N) / 2π of its circle; blades as curved as the circle fill all of it.
TEST(StopMask, PolygonsFillTheirPartOfTheCircle) {
    for (const int blades : {3, 5, 6, 9}) {
        const double expected = blades * std::sin(2.0 * std::numbers::pi / blades) / (2.0 * std::numbers::pi);
        EXPECT_NEAR(mask_transmittance(StopMask(PolygonStop{.blades = blades, .rotation_deg = 11.0})), expected, 1e-3);
        EXPECT_NEAR(mask_transmittance(StopMask(PolygonStop{.blades = blades, .curvature = 1.0})), 1.0, 1e-3);
        const double half_curved = mask_transmittance(StopMask(PolygonStop{.blades = blades, .curvature = 0.5}));
        EXPECT_GT(half_curved, expected);
        EXPECT_LT(half_curved, 1.0);
    }
    // A corner points along the stated rotation.
    const StopMask triangle(PolygonStop{.blades = 3, .rotation_deg = 90.0});
    EXPECT_EQ(triangle.transmittance(0.0, 0.99), 1.0);
    EXPECT_EQ(triangle.transmittance(0.0, -0.6), 0.0);
}

TEST(StopMask, EndsRaysInTheTracerAsStopped) {
    Prescription prescription = biconvex(1.6, 5.0);
    prescription.stop_shape = PolygonStop{.blades = 4, .rotation_deg = 0.0};  // |x| + |y| ≤ 5
    const TraceLens<double> lens = traceable(prescription);
    // From the stop outwards and back: along x the corner lies at 5 mm, along the diagonal the edge at 5/√2.
    const auto status = [&](double x, double y) {
        const TraceLens<double> stop_alone{{lens.surfaces[2]}, lens.image_z, lens.specials};
        return trace(stop_alone, Ray<double>{{x, y, 0.0}, {0.0, 0.0, 1.0}}).status;
    };
    EXPECT_EQ(status(4.99, 0.0), RayStatus::ok);
    EXPECT_EQ(status(2.49, 2.49), RayStatus::ok);
    EXPECT_EQ(status(2.51, 2.51), RayStatus::stopped);
    EXPECT_EQ(status(0.0, -5.01), RayStatus::stopped);
}

TEST(Barrel, CutsAtBothEndsOfItsSpace) {
    Prescription prescription = biconvex();
    prescription.surfaces[1].barrel_mm = 7.0;
    const Lens lens = make_lens(prescription, GlassCatalogue{});
    EXPECT_EQ(lens.surfaces[0].semi_diameter, 50.0);
    EXPECT_EQ(lens.surfaces[1].semi_diameter, 7.0);
    EXPECT_EQ(lens.surfaces[2].semi_diameter, 7.0);
}

// Two thin lenses of 100 and −150 mm, of index 1.5, so that each radius is the focal length. Moving the front one
// forward by s images an object 1/(1/100 − 1/i) away where the front lens alone images it i = s + its focal length
// behind itself, since then the rear lens sees the same.
TEST(FocusGroup, MovesUntilTheImageIsSharp) {
    const auto thin = [](double focal_length) { return row(focal_length, 0.0, 1.5); };
    Prescription prescription =
        prescription_of({thin(100.0), row(-100.0, 30.0), stop_row(10.0, 5.0), thin(-150.0), row(150.0, 0.0)});
    // Behind the rear lens: 1/i = 1/60 − 1/150.
    prescription.surfaces.back().thickness_mm = 1.0 / (1.0 / 60.0 - 1.0 / 150.0);
    prescription.focus_groups = {{.first = 1, .last = 2, .travel = 1.0}};
    const Lens lens = make_lens(prescription, GlassCatalogue{});
    constexpr double kDrive = 5.0;
    const double object_from_group = 1.0 / (1.0 / 100.0 - 1.0 / (100.0 + kDrive));
    const Lens focused = focused_at(lens, object_from_group + kDrive);
    EXPECT_NEAR(focused.surfaces[0].vertex_z, -kDrive, 1e-6);
    EXPECT_NEAR(focused.surfaces[1].vertex_z, -kDrive, 1e-6);
    EXPECT_EQ(focused.surfaces[3].vertex_z, lens.surfaces[3].vertex_z);
    EXPECT_EQ(focused.image_z, lens.image_z);
}

TEST(ZoomPosition, ReplacesGapsStopAndClaims) {
    Prescription prescription = biconvex();
    prescription.stated.efl_mm = 50.0;
    prescription.stated.f_number = 4.0;
    prescription.zoom = {{.name = "wide"}, {.name = "long", .gaps_mm = {{2, 9.0}}, .stop_semi_diameter_mm = 8.0}};
    prescription.zoom[1].stated.efl_mm = 80.0;
    const Prescription chosen = at_zoom_position(prescription, find_zoom_position(prescription, "long"));
    EXPECT_EQ(chosen.surfaces[1].thickness_mm, 9.0);
    EXPECT_EQ(*chosen.surfaces[2].semi_diameter_mm, 8.0);
    EXPECT_EQ(*chosen.stated.efl_mm, 80.0);
    EXPECT_EQ(*chosen.stated.f_number, 4.0);
    EXPECT_EQ(find_zoom_position(prescription, "1"), 0U);
    EXPECT_FALSE(at_zoom_position(prescription, 0).stated.efl_mm.has_value());
    prescription.stated.half_field_deg = 20.0;
    EXPECT_EQ(*at_zoom_position(prescription, 1).stated.half_field_deg, 20.0);
    EXPECT_ANY_THROW(find_zoom_position(prescription, "middle"));
}

// Air at 20 °C and 101 325 Pa has n − 1 = 2.724e-4 at the d line (2.718e-4 at 633 nm by NIST's calculator): a
// catalogue's index, relative to it, is that much higher against vacuum. And the wavelength in air is 0.163 nm shorter,
// which by N-BK7's dn/dλ of −4.18e-5 / nm adds 4.5e-6 of 1.5168. Both are known to 1e-7.
TEST(Medium, InVacuumIsTheCataloguesTimesThatOfAir) {
    Prescription prescription = biconvex(1.0);
    prescription.surfaces[0].medium.glass = "N-BK7";
    const auto index = [&] {
        return at_wavelength<double>(make_lens(prescription, formats::shipped_glasses()), kWavelength);
    };
    const double in_air = index().surfaces[0].index_after;
    EXPECT_NEAR(in_air, 1.5168, 1e-6);
    prescription.surroundings = Surroundings::vacuum;
    const TraceLens<double> in_vacuum = index();
    EXPECT_NEAR(in_vacuum.surfaces[0].index_after / in_air, 1.0002724 + 4.5e-6, 5e-7);
    EXPECT_EQ(in_vacuum.surfaces[1].index_after, 1.0);
}

// A table of indices counts before the name and the figures beside it, and ends where it ends.
TEST(Medium, TableOfIndicesIsMetAtItsWavelengths) {
    Prescription prescription = biconvex(1.0);
    prescription.surfaces[0].medium = {.n_d = 1.9, .indices = {{486.1, 1.63}, {587.6, 1.62}, {656.3, 1.616}}};
    const Lens lens = make_lens(prescription, GlassCatalogue{});
    EXPECT_DOUBLE_EQ(at_wavelength<double>(lens, 587.6).surfaces[0].index_after, 1.62);
    EXPECT_DOUBLE_EQ(at_wavelength<double>(lens, 656.3).surfaces[0].index_after, 1.616);
    EXPECT_ANY_THROW(at_wavelength<double>(lens, 700.0));
}

// Where no semi-diameter is stated, it is the height of the field's uppermost ray: a plane at the stop needs the pupil
// alone, a sphere 20 mm behind it what the ray from the pupil's edge meets (to the 1e-9 that a rim is wider).
TEST(SemiDiameter, IsEstimatedFromApertureAndField) {
    PrescribedSurface front = row(50.0, 0.0, 1.5);
    PrescribedSurface rear = row(-50.0, 50.0);
    front.semi_diameter_mm.reset();
    rear.semi_diameter_mm.reset();
    PrescribedSurface stop = stop_row(20.0);
    stop.semi_diameter_mm.reset();
    Prescription prescription = prescription_of({stop, front, rear});
    EXPECT_ANY_THROW(make_lens(prescription, GlassCatalogue{}));
    prescription.stated.f_number = 5.0;
    prescription.stated.half_field_deg = 10.0;
    const Lens lens = make_lens(prescription, GlassCatalogue{});
    EXPECT_NEAR(lens.surfaces[0].semi_diameter, 5.0, 1e-12);
    const double sine = std::sin(radians(10.0));
    const double cosine = std::cos(radians(10.0));
    const double y = 5.0;  // from the sphere's centre
    const double z = -70.0;
    const double along = y * sine + z * cosine;
    const double path = -along - std::sqrt(along * along - (y * y + z * z - 2500.0));
    EXPECT_NEAR(lens.surfaces[1].semi_diameter, y + path * sine, 2e-8);
}

}  // namespace lensproof::optics::special_surface_test
