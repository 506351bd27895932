// Seidel and colour sums against closed forms, against real rays in the limit of small fields and apertures, and
// against 50 digits.
#include "engine/analysis/seidel.h"

#include <gtest/gtest.h>

#include <array>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <cmath>

#include "engine/base/angle.h"
#include "engine/base/infinity.h"
#include "engine/formats/prescription/load_lens.h"
#include "engine/optics/convert_lens.h"
#include "engine/optics/lens.h"
#include "engine/spectral/wavelengths.h"
#include "tests/engine/analysis/analysis_lens.h"

namespace lensproof::analysis::seidel_test {

using Term = double SeidelTerms<double>::*;
using Terms = SeidelTerms<double>;
constexpr std::array<Term, 7> kTerms = {&Terms::s1, &Terms::s2, &Terms::s3, &Terms::s4,
                                        &Terms::s5, &Terms::c1, &Terms::c2};

/// The sums of a lens without dispersion.
SeidelSums<double> sums_of(const optics::TraceLens<double>& lens, double field_angle,
                           double object_distance = kInfinity) {
    return seidel_sums(lens, lens, lens, field_angle, object_distance).value();
}

optics::TraceLens<double> with_indices_changed(optics::TraceLens<double> lens, double relative_change) {
    for (optics::TraceSurface<double>& surface : lens.surfaces) {
        // As a glass's dispersion grows with its index.
        const auto changed = [&](double n) { return n + relative_change * (n - 1.0) * (n - 1.0); };
        surface.index_before = changed(surface.index_before);
        surface.index_after = changed(surface.index_after);
    }
    return lens;
}

void expect_equal(const Terms& found, const Terms& expected, double tolerance) {
    for (const Term term : kTerms) {
        EXPECT_NEAR(found.*term, expected.*term, tolerance);
    }
}

// A plane-parallel plate of thickness t in a beam of marginal slope u and chief slope ū (Welford, ch. 8, with ū / u for
// the factor from one sum to the next): S1 = −(n² − 1) t u⁴ / n³, S4 = 0, and C1 = −δn t u² / n². Wherever it stands.
TEST(Seidel, PlaneParallelPlate) {
    constexpr double n = 1.6;
    constexpr double t = 10.0;
    constexpr double dn = 0.01;
    for (const double distance : {-100.0, -15.0, 60.0}) {
        const optics::TraceLens<double> plate = lens_of<double>(
            {{.thickness = 3.0, .semi_diameter = 4.0, .is_stop = true}, {.thickness = t, .index = n}, {}});
        optics::TraceLens<double> blue = plate;
        blue.surfaces[1].index_after = blue.surfaces[2].index_before = n + dn;
        const double u = 4.0 / distance;
        const double ratio = std::tan(0.2) / u;
        const double s1 = -(n * n - 1) * t * std::pow(u, 4) / (n * n * n);
        const double c1 = -dn * t * u * u / (n * n);
        const Terms expected{.s1 = s1,
                             .s2 = s1 * ratio,
                             .s3 = s1 * ratio * ratio,
                             .s4 = 0.0,
                             .s5 = s1 * ratio * ratio * ratio,
                             .c1 = c1,
                             .c2 = c1 * ratio};
        const SeidelSums<double> sums = seidel_sums(plate, blue, plate, 0.2, distance).value();
        for (const Term term : kTerms) {
            // The two faces cancel but for t / distance.
            EXPECT_NEAR(sums.total.*term, expected.*term, 1e-14 * std::abs(sums.surfaces[1].*term));
            EXPECT_EQ(sums.surfaces[0].*term, 0.0);
        }
    }
}

// Cartesian surfaces: an ellipsoid of k = −1/n² images infinity from air into glass, a hyperboloid of k = −n² from
// glass into air, perfectly (Born & Wolf, §4.2). What the sphere and the figure add cancels.
TEST(Seidel, CartesianSurfacesHaveNoSphericalAberration) {
    for (const double n : {1.3, 1.5, 2.0, 4.0}) {
        const auto ellipsoid = [&](double conic) {
            return sums_of(
                lens_of<double>({{.radius = 30.0, .index = n, .conic = conic, .semi_diameter = 9.0, .is_stop = true}}),
                0.1);
        };
        EXPECT_NEAR(ellipsoid(-1 / (n * n)).total.s1, 0.0, 1e-14 * ellipsoid(0.0).total.s1);
        const auto hyperboloid = [&](double conic) {
            return sums_of(lens_of<double>({{.thickness = 5.0, .index = n, .semi_diameter = 9.0, .is_stop = true},
                                            {.radius = -30.0, .conic = conic}}),
                           0.1);
        };
        EXPECT_NEAR(hyperboloid(-n * n).total.s1, 0.0, 1e-14 * hyperboloid(0.0).total.s1);
    }
}

// The aplanatic points of a sphere (Welford, ch. 8; Born & Wolf, §4.2): light that converges to R (1 + n) behind the
// vertex has its image at R (1 + 1/n), free of spherical aberration, coma and astigmatism; towards the centre of
// curvature it is free of the first two. An object at the vertex has neither these nor astigmatism, but the Petzval
// curvature, and the distortion that a formula with Ā / A or ȳ / y would divide by 0 for.
TEST(Seidel, AplanaticPointsOfASphere) {
    constexpr double n = 1.5;
    constexpr double R = 32.0;
    const optics::TraceLens<double> lens =
        lens_of<double>({{.thickness = 4.0, .semi_diameter = 3.0, .is_stop = true}, {.radius = R, .index = n}});
    const double field = 0.3;
    const double scale = sums_of(lens, field, 500.0).total.s3;

    const Terms aplanatic = sums_of(lens, field, -(R * (1 + n) + 4.0)).total;
    EXPECT_NEAR(aplanatic.s1, 0.0, 1e-15 * scale);
    EXPECT_NEAR(aplanatic.s2, 0.0, 1e-15 * scale);
    EXPECT_NEAR(aplanatic.s3, 0.0, 1e-15 * scale);
    EXPECT_GT(aplanatic.s4, 0.0);

    const Terms concentric = sums_of(lens, field, -(R + 4.0)).total;
    EXPECT_NEAR(concentric.s1, 0.0, 1e-15 * scale);
    EXPECT_NEAR(concentric.s2, 0.0, 1e-15 * scale);
    EXPECT_GT(std::abs(concentric.s3), 1e-3 * scale);

    const Terms at_vertex = sums_of(lens, field, -4.0).total;
    EXPECT_EQ(at_vertex.s1, 0.0);
    EXPECT_EQ(at_vertex.s2, 0.0);
    EXPECT_EQ(at_vertex.s3, 0.0);
    // A = n u, y = 0, H = A ȳ: S4 = H² c (n' − n)/(n n'), and S5 = Ā ȳ H c (n' − n)/(n n') = S4 Ā / A.
    const double u = -3.0 / 4.0;
    const double slope = std::tan(field);
    const double s4 = std::pow(u * 4.0 * slope, 2) / R * (n - 1) / n;
    EXPECT_NEAR(at_vertex.s4, s4, 1e-14 * s4);
    EXPECT_NEAR(at_vertex.s5, s4 * (slope + 4.0 * slope / R) / u, 1e-14 * std::abs(s4));
}

// S4 = −H² / ρ with ρ the Petzval radius (of a lens in air), whatever bending, figure, stop and conjugates.
TEST(Seidel, PetzvalSumKnowsPowersAlone) {
    const double field = 0.2;
    for (const double conic : {0.0, -4.0}) {
        for (const double bending : {-0.03, 0.0, 0.02}) {
            for (const double distance : {kInfinity, 150.0}) {
                const optics::TraceLens<double> lens = lens_of<double>(
                    {{.radius = 1 / (0.01 + bending), .thickness = 5.0, .index = 1.6, .conic = conic, .a4 = 1e-6},
                     {.radius = 1 / bending, .thickness = 3.0},
                     {.semi_diameter = 6.0, .is_stop = true}});
                const double invariant = optics::lagrange_invariant(lens, field).value();
                const double expected = -invariant * invariant / optics::paraxial_data(lens).petzval_radius;
                EXPECT_NEAR(sums_of(lens, field, distance).total.s4, expected, 1e-13 * expected);
            }
        }
    }
}

/// A lens of two elements and three figured surfaces, behind a plane in air for a stop in front and before one for a
/// stop behind. `stop` is 0, 3 or 6.
std::vector<Row> figured_lens(int stop, double semi_diameter) {
    std::vector<Row> rows = {{.thickness = 8.0},
                             {.radius = 30.0, .thickness = 6.0, .index = 1.6, .conic = -0.7, .a4 = 3e-6},
                             {.radius = 80.0, .thickness = 3.0},
                             {.thickness = 4.0},
                             {.radius = -40.0, .thickness = 2.0, .index = 1.7, .conic = 2.0, .a2 = 1e-3, .a4 = -2e-6},
                             {.radius = 90.0, .thickness = 3.0, .a6 = 1e-9},
                             {.thickness = 100.0}};
    rows[stop].is_stop = true;
    rows[stop].semi_diameter = semi_diameter;
    return rows;
}

// The stop-shift equations (Welford, ch. 8): with the marginal ray kept and Q = (ȳ* − ȳ) / y, one number for all
// surfaces, S1* = S1, S2* = S2 + Q S1, S3* = S3 + 2 Q S2 + Q² S1, S4* = S4, S5* = S5 + Q (3 S3 + S4) + 3 Q² S2 + Q³ S1,
// C1* = C1, C2* = C2 + Q C1: for each surface.
TEST(Seidel, StopShift) {
    const double field = 0.2;
    for (const double distance : {kInfinity, 400.0}) {
        const optics::TraceLens<double> before = lens_of<double>(figured_lens(0, 5.0));
        const optics::ParaxialRay marginal = optics::paraxial_marginal_ray(before, distance).value();
        const double slope = std::tan(field);
        const auto sums = [&](const optics::TraceLens<double>& lens) {
            return seidel_sums(with_indices_changed(lens, 0.0), with_indices_changed(lens, 0.02),
                               with_indices_changed(lens, -0.02), field, distance)
                .value();
        };
        const SeidelSums<double> old_sums = sums(before);
        for (const int stop : {3, 6}) {
            const double at_stop = optics::trace_paraxial(before, marginal, 0, stop).height;
            const optics::TraceLens<double> after = lens_of<double>(figured_lens(stop, at_stop));
            // The field is that of one object point: H is kept, and with it n ū y − n u ȳ. For an object at infinity ū
            // is the same; for a near one the new chief ray has another angle.
            const optics::ParaxialRay chief = optics::paraxial_chief_ray(after, field).value();
            const double old_invariant = marginal.height * slope;  // ȳ = 0 at the old stop, which is surface 0
            const double new_invariant = marginal.height * chief.slope - marginal.slope * chief.height;
            const double scale = old_invariant / new_invariant;
            const double new_field = std::atan(scale * slope);
            const SeidelSums<double> new_sums = seidel_sums(after, with_indices_changed(after, 0.02),
                                                            with_indices_changed(after, -0.02), new_field, distance)
                                                    .value();
            const double q = scale * chief.height / marginal.height;
            const auto shifted = [&](const Terms& s) {
                return Terms{.s1 = s.s1,
                             .s2 = s.s2 + q * s.s1,
                             .s3 = s.s3 + 2 * q * s.s2 + q * q * s.s1,
                             .s4 = s.s4,
                             .s5 = s.s5 + q * (3 * s.s3 + s.s4) + 3 * q * q * s.s2 + q * q * q * s.s1,
                             .c1 = s.c1,
                             .c2 = s.c2 + q * s.c1};
            };
            for (std::size_t i = 0; i < old_sums.surfaces.size(); ++i) {
                expect_equal(new_sums.surfaces[i], shifted(old_sums.surfaces[i]), 1e-14);
            }
            expect_equal(new_sums.total, shifted(old_sums.total), 1e-14);
            EXPECT_GT(std::abs(q), 0.05);
        }
    }
}

// Figures that agree to r⁴ agree to third order: a paraboloid as a conic, as an r² term on a plane, and as both; a
// sphere as its series.
TEST(Seidel, FiguresThatAgreeToTheFourthPowerAreOne) {
    constexpr double R = 40.0;
    const auto sums = [](Row front) {
        front.thickness = 6.0;
        front.index = 1.7;
        return sums_of(
            lens_of<double>({front, {.radius = -80.0, .thickness = 2.0}, {.semi_diameter = 7.0, .is_stop = true}}),
            0.2);
    };
    const SeidelSums<double> paraboloid = sums({.radius = R, .conic = -1.0});
    const SeidelSums<double> r2_term = sums({.a2 = 0.5 / R});
    // Half from the curvature and half from the r² term; r⁴ of the sphere of half the curvature is taken off.
    const SeidelSums<double> both = sums({.radius = 2 * R, .a2 = 0.25 / R, .a4 = -std::pow(0.5 / R, 3) / 8});
    const SeidelSums<double> sphere = sums({.radius = R});
    const SeidelSums<double> series =
        sums({.a2 = 0.5 / R, .a4 = std::pow(1 / R, 3) / 8, .a6 = std::pow(1 / R, 5) / 16});
    // Along a sphere's normals a r² is a r² (1 + c² r² / 2) along the axis, to r⁴.
    const SeidelSums<double> along_axis = sums({.radius = R, .a2 = 1e-3, .a4 = 2e-6 + 5e-4 / (R * R)});
    const SeidelSums<double> along_normal = sums({.radius = R, .a2 = 1e-3, .a4 = 2e-6, .along_normal = true});
    for (std::size_t i = 0; i < 3; ++i) {
        expect_equal(along_normal.surfaces[i], along_axis.surfaces[i], 1e-15);
        expect_equal(r2_term.surfaces[i], paraboloid.surfaces[i], 1e-15);
        expect_equal(both.surfaces[i], paraboloid.surfaces[i], 1e-15);
        expect_equal(series.surfaces[i], sphere.surfaces[i], 1e-15);
    }
    EXPECT_GT(std::abs(sphere.total.s1 - paraboloid.total.s1), 1e-4);
}

/// A case for real rays: a lens, its field, and its object.
struct RayCase {
    const char* name;
    optics::TraceLens<long double> lens;
    long double field_angle;
    long double object_distance;
};

/// Where a real ray, through the point `pupil` of the entrance pupil, relative to its edge, and from the fraction
/// `field` of the field, meets the paraxial image plane, less the paraxial image.
Vec2<long double> real_ray_error(const RayCase& c, Vec2<long double> pupil, long double field) {
    using T = long double;
    const auto data = optics::paraxial_data(c.lens);
    const T slope = field * std::tan(c.field_angle);
    const T radius = data.entrance_pupil_diameter / 2;
    const Vec3<T> in_pupil{pupil.x * radius, pupil.y * radius, data.entrance_pupil_z};
    Ray<T> ray{in_pupil, normalized(Vec3<T>{T(0), slope, T(1)})};
    if (std::isfinite(c.object_distance)) {
        const Vec3<T> object{T(0), -slope * (c.object_distance + data.entrance_pupil_z), -c.object_distance};
        ray = {object, normalized(in_pupil - object)};
    }
    const optics::TracedRay<T> traced = optics::trace_past_rims(c.lens, ray);
    const int last = static_cast<int>(c.lens.surfaces.size()) - 1;
    const T image_distance = optics::paraxial_image_distance(c.lens, c.object_distance);
    const Vec3<T> point = optics::meet_plane(traced.ray, c.lens.surfaces.back().vertex_z + image_distance).point;
    const auto chief = optics::trace_paraxial(c.lens, {-slope * data.entrance_pupil_z, slope}, 0, last);
    return {point.x, point.y - (chief.height + image_distance * chief.slope)};
}

/// The same to third order: the gradient, over n' u', of the wavefront aberration (Hopkins; Welford, ch. 8)
///     W = S1/8 ρ⁴ + S2/2 η ρ³ cos φ + S3/2 η² ρ² cos² φ + (S3 + S4)/4 η² ρ² + S5/2 η³ ρ cos φ,   φ from +y.
Vec2<long double> third_order_ray_error(const SeidelSums<long double>& sums, Vec2<long double> pupil,
                                        long double field) {
    const SeidelTerms<long double>& s = sums.total;
    const long double rho2 = dot(pupil, pupil);
    const long double field2 = field * field;
    const long double x = (s.s1 * rho2 + 2 * s.s2 * field * pupil.y + (s.s3 + s.s4) * field2) * pupil.x;
    const long double y = (s.s1 * rho2 + (3 * s.s3 + s.s4) * field2) * pupil.y +
                          s.s2 * field * (rho2 + 2 * pupil.y * pupil.y) + s.s5 * field2 * field;
    return Vec2<long double>{x, y} / (2 * sums.image_slope);
}

std::vector<RayCase> ray_cases() {
    const auto shipped = [](const char* name) {
        return optics::at_wavelength<long double>(formats::load_lens(name), spectral::kLineD);
    };
    const long double infinity = std::numeric_limits<long double>::infinity();
    return {
        {"tessar", shipped("tessar"), 0.3L, infinity},
        {"triplet", shipped("triplet-cooke"), 0.3L, infinity},
        {"triplet at 150 mm", shipped("triplet-cooke"), 0.3L, 150.0L},
        {"fisheye", shipped("muller-fisheye"), 0.5L, infinity},
        {"figured lens", lens_of<long double>(figured_lens(3, 5.0)), 0.2L, infinity},
        {"figured lens, stop behind, at 300 mm", lens_of<long double>(figured_lens(6, 5.0)), 0.2L, 300.0L},
        {"spherical mirror, stop in front",
         lens_of<long double>({{.thickness = 80.0, .semi_diameter = 20.0, .is_stop = true},
                               {.radius = -200.0, .thickness = -100.0, .index = -1.0}}),
         0.2L, infinity},
        {"Mangin's mirror",
         lens_of<long double>(
             {{.radius = -150.0, .thickness = 8.0, .index = 1.5168, .semi_diameter = 30.0, .is_stop = true},
              {.radius = -240.0, .thickness = -8.0, .index = -1.5168},
              {.radius = -150.0, .thickness = -160.0, .index = -1.0}}),
         0.1L, infinity},
        {"two mirrors, at 5 m",
         lens_of<long double>({{.radius = -1000.0,
                                .thickness = -350.0,
                                .index = -1.0,
                                .conic = -1.0,
                                .semi_diameter = 50.0,
                                .is_stop = true},
                               {.radius = -400.0, .thickness = 600.0, .index = 1.0, .conic = -2.0}}),
         0.05L, 5000.0L},
        {"sensor in glass",
         lens_of<long double>({{.radius = 50.0, .thickness = 5.0, .index = 1.6, .semi_diameter = 8.0, .is_stop = true},
                               {.radius = -80.0, .thickness = 100.0, .index = 1.5}}),
         0.2L, infinity}};
}

// What third-order theory is: with pupil and field both scaled by t, a real ray's error is t³ times the sums'
// prediction and a fifth-order part, so the deviation of error / t³ from the prediction falls with t². Halving t
// divides it by 4, but for its own t⁴, which t = 1/64 leaves at a few percent. The five rays tell all five sums apart:
// the axial ray knows S1 alone, the chief ray S5, the others each a different sum of the rest.
TEST(Seidel, RealRaysAgreeInTheLimit) {
    for (const RayCase& c : ray_cases()) {
        const auto sums = seidel_sums(c.lens, c.lens, c.lens, c.field_angle, c.object_distance).value();
        // Pupil x, pupil y, field.
        for (const Vec3<long double>& at : {Vec3<long double>{0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}, {0, -1, 1}}) {
            const Vec2<long double> predicted = third_order_ray_error(sums, {at.x, at.y}, at.z);
            const auto deviation = [&](long double t) {
                return length(real_ray_error(c, {t * at.x, t * at.y}, t * at.z) / (t * t * t) - predicted);
            };
            const long double first = deviation(1.0L / 64);
            const long double second = deviation(1.0L / 128);
            EXPECT_LT(first, 0.02L * length(predicted)) << c.name << " " << at.x << " " << at.y << " " << at.z;
            EXPECT_NEAR(second / first, 0.25L, 0.02L) << c.name << " " << at.x << " " << at.y << " " << at.z;
        }
    }
}

// Colour sums are the small-dispersion limit of paraxial tracing: with indices changed by ±s δ, the foci differ by
// −C1 / (n' u'²) and the heights at which one incoming chief ray meets the reference's image plane by C2 / (n' u'), to
// a relative error that falls with s².
TEST(Seidel, ColourIsTheLimitOfSmallDispersion) {
    const optics::TraceLens<double> lens =
        optics::at_wavelength<double>(formats::load_lens("triplet-cooke"), spectral::kLineD);
    const int last = static_cast<int>(lens.surfaces.size()) - 1;
    for (const double distance : {kInfinity, 500.0}) {
        const double image_distance = optics::paraxial_image_distance(lens, distance);
        const optics::ParaxialRay chief = optics::paraxial_chief_ray(lens, 0.3).value();
        const auto deviation = [&](double s) {
            const optics::TraceLens<double> blue = with_indices_changed(lens, s);
            const optics::TraceLens<double> red = with_indices_changed(lens, -s);
            const SeidelSums<double> sums = seidel_sums(lens, blue, red, 0.3, distance).value();
            const double axial =
                optics::paraxial_image_distance(blue, distance) - optics::paraxial_image_distance(red, distance);
            const auto height = [&](const optics::TraceLens<double>& coloured) {
                const optics::ParaxialRay out = optics::trace_paraxial(coloured, chief, 0, last);
                return out.height + image_distance * out.slope;
            };
            const double lateral = height(blue) - height(red);
            const double slope = sums.image_slope;
            return Vec2d{axial / (-sums.total.c1 / (slope * slope)) - 1, lateral / (sums.total.c2 / slope) - 1};
        };
        const Vec2d coarse = deviation(0.02);
        const Vec2d fine = deviation(0.01);
        EXPECT_LT(std::abs(fine.x), 0.02);
        EXPECT_LT(std::abs(fine.y), 0.02);
        EXPECT_NEAR(fine.x / coarse.x, 0.25, 0.02);
        EXPECT_NEAR(fine.y / coarse.y, 0.25, 0.02);
    }
}

// What has no paraxial rays has no sums.
TEST(Seidel, SaysWhereThereAreNone) {
    const optics::TraceLens<double> lens =
        optics::at_wavelength<double>(formats::load_lens("muller-fisheye"), spectral::kLineD);
    EXPECT_TRUE(seidel_sums(lens, lens, lens, 89.9 * kDegree));
    EXPECT_FALSE(seidel_sums(lens, lens, lens, 90.0 * kDegree));
    EXPECT_FALSE(seidel_sums(lens, lens, lens, 135.0 * kDegree));
    const optics::TraceLens<double> telecentric =
        lens_of<double>({{.radius = 64.0, .index = 2.0}, {.thickness = 64.0}, {.semi_diameter = 4.0, .is_stop = true}});
    EXPECT_FALSE(seidel_sums(telecentric, telecentric, telecentric, 0.1, 128.0));
    optics::TraceLens<double> unlimited = lens;
    for (optics::TraceSurface<double>& surface : unlimited.surfaces) {
        surface.semi_diameter_squared = kInfinity;
    }
    EXPECT_FALSE(seidel_sums(unlimited, unlimited, unlimited, 0.1));
    const SeidelSums<double> on_axis = sums_of(lens, 0.0);
    EXPECT_NE(on_axis.total.s1, 0.0);
    for (const Term term : {&Terms::s2, &Terms::s3, &Terms::s4, &Terms::s5}) {
        EXPECT_EQ(on_axis.total.*term, 0.0);
    }
}

// The same formulas in 50 digits, against the largest contribution of a surface.
TEST(Seidel, DoubleAgreesWithFiftyDigits) {
    using Wide = boost::multiprecision::cpp_bin_float_50;
    for (const char* name :
         {"tessar", "petzval", "double-gauss-angenieux", "distagon-28", "triplet-cooke", "muller-fisheye",
          "nikkor-fisheye-10", "fisheye-220", "gyogyotto", "canon-zoom-70-200", "super-takumar-135"}) {
        const optics::Lens lens = formats::load_lens(name);
        const optics::TraceLens<double> d = optics::at_wavelength<double>(lens, spectral::kLineD);
        const optics::TraceLens<double> blue = optics::at_wavelength<double>(lens, 486.1327);
        const optics::TraceLens<double> red = optics::at_wavelength<double>(lens, 656.2725);
        for (const double distance : {kInfinity, 1000.0}) {
            const auto sums = seidel_sums(d, blue, red, 0.4, distance).value();
            const auto wide = seidel_sums(optics::convert_lens<Wide>(d), optics::convert_lens<Wide>(blue),
                                          optics::convert_lens<Wide>(red), Wide(0.4), Wide(distance))
                                  .value();
            const auto compare = [&](Term term, Wide SeidelTerms<Wide>::*wide_term) {
                double largest = 0.0;
                for (const auto& surface : sums.surfaces) {
                    largest = std::max(largest, std::abs(surface.*term));
                }
                const double tolerance = 1e-11 * largest;
                for (std::size_t i = 0; i < sums.surfaces.size(); ++i) {
                    EXPECT_NEAR(sums.surfaces[i].*term, static_cast<double>(wide.surfaces[i].*wide_term), tolerance)
                        << name << " " << i + 1;
                }
                EXPECT_NEAR(sums.total.*term, static_cast<double>(wide.total.*wide_term), tolerance) << name;
            };
            compare(&Terms::s1, &SeidelTerms<Wide>::s1);
            compare(&Terms::s2, &SeidelTerms<Wide>::s2);
            compare(&Terms::s3, &SeidelTerms<Wide>::s3);
            compare(&Terms::s4, &SeidelTerms<Wide>::s4);
            compare(&Terms::s5, &SeidelTerms<Wide>::s5);
            compare(&Terms::c1, &SeidelTerms<Wide>::c1);
            compare(&Terms::c2, &SeidelTerms<Wide>::c2);
        }
    }
}

}  // namespace lensproof::analysis::seidel_test
