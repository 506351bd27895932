// First-order data against closed forms, against identities that hold between them, and against 50 digits.
#include <gtest/gtest.h>

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <cmath>

#include "engine/analysis/working_f_number.h"
#include "engine/base/angle.h"
#include "engine/base/infinity.h"
#include "engine/formats/prescription/load_lens.h"
#include "engine/optics/convert_lens.h"
#include "engine/optics/focus.h"
#include "engine/optics/lens.h"
#include "engine/optics/paraxial.h"
#include "engine/spectral/wavelengths.h"
#include "tests/engine/analysis/analysis_lens.h"

namespace lensproof::analysis::first_order_test {

// Room for some tens of roundings.
constexpr double kRounding = 1e-14;

void expect_relative(double value, double expected, double tolerance) {
    EXPECT_NEAR(value, expected, tolerance * std::abs(expected));
}

optics::TraceLens<double> shipped(const char* name) {
    return optics::at_wavelength<double>(formats::load_lens(name), spectral::kLineD);
}

// Hecht, Optics, §6.1: efl n R / (2 (n − 1)); bfl = efl − R; both principal points at the centre. Two surfaces of power
// (n − 1) / R give a Petzval radius of −n R / (2 (n − 1)), which is −efl.
TEST(FirstOrder, BallLens) {
    constexpr double n = 1.5;
    constexpr double R = 10.0;
    const optics::ParaxialData data =
        optics::paraxial_data(lens_of<double>({{.radius = R, .thickness = R, .index = n},
                                               {.thickness = R, .index = n, .semi_diameter = 2.0, .is_stop = true},
                                               {.radius = -R}}));
    const double efl = n * R / (2 * (n - 1));
    expect_relative(data.efl, efl, kRounding);
    expect_relative(data.bfl, efl - R, 2 * kRounding);
    expect_relative(data.ffl, -(efl - R), 2 * kRounding);
    expect_relative(data.front_principal_z, R, kRounding);
    expect_relative(data.rear_principal_z, -R, kRounding);
    EXPECT_EQ(data.front_nodal_z, data.front_principal_z);
    EXPECT_EQ(data.rear_nodal_z, data.rear_principal_z);
    expect_relative(data.petzval_radius, -efl, kRounding);
    // Symmetric about its middle, a centre of curvature: both pupils stand there, magnified n times.
    expect_relative(data.entrance_pupil_z, R, 10 * kRounding);
    expect_relative(data.exit_pupil_z, -R, 10 * kRounding);
    expect_relative(data.entrance_pupil_diameter, 4.0 * n, 10 * kRounding);
    expect_relative(data.exit_pupil_diameter, 4.0 * n, 10 * kRounding);
}

// Thick lenses (Hecht, Optics, §6.1): 1/f = (n − 1) (1/R1 − 1/R2 + (n − 1) d / (n R1 R2)), principal points at
// −f (n − 1) d / (n R2) and −f (n − 1) d / (n R1). The last, of a focal length of 1000 km, has them 3 mm inside the
// glass all the same: as differences of focal lengths and focal distances they would be good to 1e-7 mm only.
TEST(FirstOrder, ThickLens) {
    constexpr double n = 1.6;
    constexpr double d = 10.0;
    for (const auto& [R1, R2] : {std::pair{50.0, -70.0}, {30.0, 45.0}, {-20.0, 200.0}, {1.2e9, -1.2e9}}) {
        const optics::ParaxialData data = optics::paraxial_data(
            lens_of<double>({{.radius = R1, .thickness = d, .index = n, .is_stop = true}, {.radius = R2}}));
        const double f = 1 / ((n - 1) * (1 / R1 - 1 / R2 + (n - 1) * d / (n * R1 * R2)));
        expect_relative(data.efl, f, kRounding);
        expect_relative(data.front_principal_z, -f * (n - 1) * d / (n * R2), kRounding);
        expect_relative(data.rear_principal_z, -f * (n - 1) * d / (n * R1), kRounding);
        expect_relative(data.petzval_radius, -n / ((n - 1) * (1 / R1 - 1 / R2)), kRounding);
    }
}

// One surface between two media: principal points at its vertex, nodal points at its centre of curvature, focal lengths
// n R / (n' − n) and n' R / (n' − n) (Born & Wolf, §4.4.1).
TEST(FirstOrder, NodalPointsBetweenDifferentMedia) {
    constexpr double n = 1.33;
    constexpr double n_after = 1.77;
    constexpr double R = 8.0;
    const optics::TraceLens<double> cornea = lens_of<double>({{.radius = R, .index = n_after, .is_stop = true}}, n);
    const optics::ParaxialData data = optics::paraxial_data(cornea);
    expect_relative(data.efl, n_after * R / (n_after - n), kRounding);
    expect_relative(data.ffl, -n * R / (n_after - n), kRounding);
    EXPECT_EQ(data.front_principal_z, 0.0);
    EXPECT_EQ(data.rear_principal_z, 0.0);
    expect_relative(data.front_nodal_z, R, kRounding);
    expect_relative(data.rear_nodal_z, R, kRounding);
}

// What defines the nodal points: a ray towards the front one leaves from the rear one with its slope unchanged.
TEST(FirstOrder, NodalRayKeepsItsSlope) {
    const optics::TraceLens<double> lens = lens_of<double>({{.radius = 20.0, .thickness = 5.0, .index = 1.6},
                                                            {.thickness = 2.0, .index = 1.6, .is_stop = true},
                                                            {.radius = -60.0, .thickness = 3.0, .index = 1.7},
                                                            {.radius = 90.0, .thickness = 30.0, .index = 1.33}});
    const optics::ParaxialData data = optics::paraxial_data(lens);
    const optics::ParaxialRay out = optics::trace_paraxial(lens, {-0.2 * data.front_nodal_z, 0.2}, 0, 3);
    expect_relative(out.slope, 0.2, 10 * kRounding);
    expect_relative(-out.height / out.slope, data.rear_nodal_z, 100 * kRounding);
}

// A plane-parallel plate moves an image by t (1 − 1/n), magnifies it once, and has no focus.
TEST(FirstOrder, PlaneParallelPlateShiftsTheImage) {
    constexpr double n = 1.5;
    constexpr double t = 12.0;
    const optics::TraceLens<double> plate =
        lens_of<double>({{.thickness = t, .index = n}, {.semi_diameter = 5.0, .is_stop = true}});
    for (const double distance : {-100.0, -0.3, 0.0, 1e-3, 40.0}) {
        const optics::Conjugates conjugates = optics::paraxial_conjugates(plate, distance);
        EXPECT_NEAR(conjugates.image_distance + t, t * (1 - 1 / n) - distance, 1e-13);
        expect_relative(conjugates.magnification, 1.0, kRounding);
    }
    const optics::ParaxialData data = optics::paraxial_data(plate);
    EXPECT_EQ(data.efl, kInfinity);
    EXPECT_EQ(data.f_number, kInfinity);
    EXPECT_EQ(data.petzval_radius, kInfinity);
    EXPECT_EQ(data.entrance_pupil_diameter, 10.0);
    EXPECT_NEAR(data.entrance_pupil_z, t / n, 1e-14);
}

/// Two thin lenses of focal lengths f and f2 with the stop at the first. Powers of two throughout, with an index of 2,
/// so that what is afocal is so exactly.
optics::TraceLens<double> thin_pair(double f, double gap, double f2) {
    return lens_of<double>({{.radius = f, .index = 2.0, .semi_diameter = 8.0, .is_stop = true},
                            {.thickness = gap},
                            {.radius = f2, .index = 2.0},
                            {}});
}

// An afocal pair (Hecht, §5.7.4): the focal lengths' ratio is the angular magnification, inverted; at every distance
// the transverse one is its inverse, and the exit pupil is the stop's image.
TEST(FirstOrder, AfocalPairs) {
    constexpr double f = 128.0;
    for (const double f2 : {32.0, -32.0}) {  // Kepler's and Galilei's
        const optics::TraceLens<double> pair = thin_pair(f, f + f2, f2);
        const optics::ParaxialData data = optics::paraxial_data(pair);
        for (const double infinite : {data.efl, data.bfl, data.rear_principal_z, data.rear_nodal_z, -data.ffl,
                                      -data.front_principal_z, -data.front_nodal_z, data.f_number}) {
            EXPECT_EQ(infinite, kInfinity);
        }
        EXPECT_EQ(optics::trace_paraxial(pair, {0.0, 1.0}, 0, 3).slope, -f / f2);
        for (const double distance : {0.0, 0.25, 64.0, 1e6, kInfinity}) {
            expect_relative(optics::paraxial_conjugates(pair, distance).magnification, -f2 / f, kRounding);
        }
        expect_relative(data.exit_pupil_diameter, 16.0 * std::abs(f2 / f), kRounding);
        expect_relative(data.exit_pupil_z, f2 * (f + f2) / f, kRounding);
        const optics::Conjugates at_infinity = optics::paraxial_conjugates(pair, kInfinity);
        EXPECT_EQ(at_infinity.image_distance, kInfinity);
        EXPECT_EQ(at_infinity.working_f_number, kInfinity);
        EXPECT_EQ(at_infinity.object_numerical_aperture, 0.0);
    }
}

// With the stop in the rear focal plane of a thin lens all chief rays enter parallel to the axis, and none has an
// angle; with the stop in the front one they leave so.
TEST(FirstOrder, TelecentricPupilsLieAtInfinity) {
    constexpr double f = 64.0;
    const optics::TraceLens<double> object_side = lens_of<double>(
        {{.radius = f, .index = 2.0}, {.thickness = f}, {.thickness = f, .semi_diameter = 4.0, .is_stop = true}});
    const optics::ParaxialData data = optics::paraxial_data(object_side);
    EXPECT_EQ(data.efl, f);
    EXPECT_EQ(data.entrance_pupil_z, kInfinity);
    EXPECT_EQ(data.entrance_pupil_diameter, kInfinity);
    EXPECT_EQ(data.f_number, 0.0);
    EXPECT_EQ(data.exit_pupil_z, 0.0);
    EXPECT_FALSE(optics::paraxial_chief_ray(object_side, 0.1));
    EXPECT_FALSE(optics::lagrange_invariant(object_side, 0.1));
    // The focus lies in the stop, which so limits nothing; a nearer object's light it does limit: from 2 f the ray that
    // meets the stop at 4 mm has slope 4 / f, and the image the same size.
    EXPECT_EQ(optics::paraxial_conjugates(object_side, kInfinity).working_f_number, 0.0);
    EXPECT_EQ(optics::paraxial_conjugates(object_side, kInfinity).object_numerical_aperture, 0.0);
    const optics::Conjugates near = optics::paraxial_conjugates(object_side, 2 * f);
    EXPECT_EQ(near.magnification, -1.0);
    EXPECT_EQ(near.object_numerical_aperture, 4.0 / f);
    EXPECT_EQ(near.working_f_number, 0.5 * f / 4.0);

    const optics::TraceLens<double> image_side = lens_of<double>(
        {{.thickness = f, .semi_diameter = 4.0, .is_stop = true}, {.radius = f, .index = 2.0}, {.thickness = f}});
    const optics::ParaxialData other = optics::paraxial_data(image_side);
    EXPECT_EQ(other.exit_pupil_z, kInfinity);
    EXPECT_EQ(other.exit_pupil_diameter, kInfinity);
    EXPECT_EQ(other.f_number, f / 8.0);
    // In the front focal plane: an image at infinity.
    const optics::Conjugates focal = optics::paraxial_conjugates(image_side, 0.0);
    EXPECT_EQ(focal.image_distance, kInfinity);
    EXPECT_EQ(focal.magnification, kInfinity);
}

// A closed stop leaves no light, and says so.
TEST(FirstOrder, ClosedStop) {
    const optics::TraceLens<double> lens =
        lens_of<double>({{.radius = 64.0, .index = 2.0},
                         {.thickness = 8.0},
                         {.thickness = 56.0, .semi_diameter = 0.0, .is_stop = true}});
    EXPECT_EQ(optics::paraxial_data(lens).entrance_pupil_diameter, 0.0);
    EXPECT_EQ(optics::paraxial_data(lens).f_number, kInfinity);
    EXPECT_EQ(optics::paraxial_conjugates(lens, 500.0).working_f_number, kInfinity);
    EXPECT_EQ(optics::paraxial_conjugates(lens, 500.0).object_numerical_aperture, 0.0);
    EXPECT_EQ(optics::lagrange_invariant(lens, 0.3), 0.0);
    EXPECT_EQ(real_working_f_number(lens), kInfinity);
}

// Newton's equation gives image and magnification, −f / x; the sine-free forms of Abbe's and of the pupil magnification
// m_p give the rest: NA = |m| / (2 N_w) and N_w = N (1 − m / m_p) (Welford, ch. 3; Kingslake, Optics in Photography).
TEST(FirstOrder, ConjugatesHangTogether) {
    for (const char* name : {"tessar", "muller-fisheye", "distagon-28", "tele-tessar-120"}) {
        const optics::TraceLens<double> lens = shipped(name);
        const optics::ParaxialData data = optics::paraxial_data(lens);
        const double pupil_magnification = data.exit_pupil_diameter / data.entrance_pupil_diameter;
        for (const double distance : {1e-3, 300.0, 1e4, 1e8, 1e15}) {
            const optics::Conjugates conjugates = optics::paraxial_conjugates(lens, distance);
            EXPECT_EQ(optics::paraxial_image_distance(lens, distance), conjugates.image_distance);
            const double x = -distance - data.ffl;
            expect_relative(conjugates.magnification, data.efl / x, 1e-12);
            EXPECT_NEAR(conjugates.image_distance - data.bfl, -data.efl * data.efl / x,
                        1e-12 * (std::abs(data.bfl) + std::abs(conjugates.image_distance)));
            expect_relative(conjugates.working_f_number,
                            data.f_number * std::abs(1 - conjugates.magnification / pupil_magnification), 1e-12);
            expect_relative(conjugates.object_numerical_aperture,
                            0.5 * std::abs(conjugates.magnification) / conjugates.working_f_number, 1e-12);
        }
        const optics::Conjugates at_infinity = optics::paraxial_conjugates(lens, kInfinity);
        expect_relative(at_infinity.image_distance, data.bfl, 1e-14);
        expect_relative(at_infinity.working_f_number, data.f_number, 1e-13);
        EXPECT_EQ(at_infinity.magnification, 0.0);
        EXPECT_EQ(at_infinity.object_numerical_aperture, 0.0);
    }
}

// n (y ū − ȳ u) is what it is in front of the lens behind every surface, and behind the lens n' u' times the image's
// height (Welford, ch. 2). Against the largest of its two terms, as these may cancel.
TEST(FirstOrder, LagrangeInvariantIsOne) {
    for (const char* name : {"tessar", "muller-fisheye", "canon-zoom-70-200"}) {
        const optics::TraceLens<double> lens = shipped(name);
        const double field = 30.0 * kDegree;
        const double expected = optics::lagrange_invariant(lens, field).value();
        expect_relative(expected, 0.5 * optics::paraxial_data(lens).entrance_pupil_diameter * std::tan(field), 1e-13);
        for (const double distance : {kInfinity, 700.0}) {
            optics::ParaxialRay marginal = optics::paraxial_marginal_ray(lens, distance).value();
            optics::ParaxialRay chief = optics::paraxial_chief_ray(lens, field).value();
            for (int i = 0; i < static_cast<int>(lens.surfaces.size()); ++i) {
                if (i > 0) {
                    const double gap = lens.surfaces[i].vertex_z - lens.surfaces[i - 1].vertex_z;
                    marginal.height += gap * marginal.slope;
                    chief.height += gap * chief.slope;
                }
                marginal = optics::trace_paraxial(lens, marginal, i, i);
                chief = optics::trace_paraxial(lens, chief, i, i);
                const double n = lens.surfaces[i].index_after;
                const double one = n * marginal.height * chief.slope;
                const double other = n * chief.height * marginal.slope;
                EXPECT_NEAR(one - other, expected, 1e-13 * (std::abs(one) + std::abs(other))) << name << " " << i + 1;
            }
            const double image_distance = optics::paraxial_image_distance(lens, distance);
            expect_relative(-marginal.slope * (chief.height + image_distance * chief.slope), expected, 1e-11);
        }
    }
    EXPECT_LT(optics::lagrange_invariant(shipped("tessar"), -0.1).value(), 0.0);
    EXPECT_FALSE(optics::lagrange_invariant(shipped("muller-fisheye"), 90.0 * kDegree));
    EXPECT_FALSE(optics::lagrange_invariant(shipped("muller-fisheye"), 135.0 * kDegree));
}

// Only the vertex's curvature counts, and all distances are from the vertices, wherever these stand.
TEST(FirstOrder, CountsVertexCurvatureAndDistancesFromVertices) {
    const auto data = [](const Row& rear, double shift) {
        optics::TraceLens<double> lens = lens_of<double>(
            {{.radius = 40.0, .thickness = 6.0, .index = 1.7, .semi_diameter = 9.0, .is_stop = true}, rear});
        for (optics::TraceSurface<double>& surface : lens.surfaces) {
            surface.vertex_z += shift;
        }
        return optics::paraxial_data(lens);
    };
    const optics::ParaxialData sphere = data({.radius = -80.0}, 0.0);
    // 1 / 100 + 2 · 0.5 (1 / 80 − 1 / 100) is 1 / 80.
    const double a2 = -0.5 * (1 / 80.0 - 1 / 100.0);
    for (const optics::ParaxialData& other : {data({.radius = -100.0, .conic = -3.0, .a2 = a2, .a4 = 1e-5}, 0.0),
                                              data({.radius = -80.0}, -5.0), data({.radius = -80.0}, 12.0)}) {
        expect_relative(other.efl, sphere.efl, kRounding);
        expect_relative(other.bfl, sphere.bfl, kRounding);
        expect_relative(other.ffl, sphere.ffl, kRounding);
        expect_relative(other.front_principal_z, sphere.front_principal_z, 10 * kRounding);
        expect_relative(other.rear_principal_z, sphere.rear_principal_z, 10 * kRounding);
        expect_relative(other.petzval_radius, sphere.petzval_radius, kRounding);
        EXPECT_EQ(other.entrance_pupil_diameter, sphere.entrance_pupil_diameter);
    }
}

// The same from a prescription: of a toroid the curvature in y–z, wherever an r² term is in it.
TEST(FirstOrder, CountsAToroidInYZ) {
    const auto data = [](double radius, double a2, std::optional<double> radius_x) {
        const optics::PrescribedSurface front{.radius_mm = radius,
                                              .asphere = {a2},
                                              .radius_x_mm = radius_x,
                                              .thickness_mm = 5.0,
                                              .semi_diameter_mm = 10.0,
                                              .medium = {.n_d = 1.5}};
        const optics::PrescribedSurface rear{.thickness_mm = 5.0, .semi_diameter_mm = 10.0, .is_stop = true};
        return optics::paraxial_data(optics::at_wavelength<double>(made_of({front, rear}), spectral::kLineD));
    };
    EXPECT_EQ(data(50.0, 0.0, std::nullopt).efl, 100.0);
    EXPECT_EQ(data(50.0, 0.0, 20.0).efl, 100.0);
    expect_relative(data(kInfinity, 0.01, kInfinity).efl, 100.0, kRounding);
    expect_relative(data(100.0, 0.005, -30.0).bfl, 100.0 - 5.0 / 1.5, kRounding);
}

// A plano-convex lens with a hyperbolic rear is free of spherical aberration: tan U' = h / (s' − sag) with s' the focus
// from its vertex, so the real f-number is known. Its paraxial one is f / 2h.
TEST(FirstOrder, RealWorkingFNumberOfAHyperboloid) {
    constexpr double n = 1.5;
    constexpr double R = 25.0;
    constexpr double h = 20.0;
    const optics::TraceLens<double> lens =
        lens_of<double>({{.thickness = 12.0, .index = n, .semi_diameter = h, .is_stop = true},
                         {.radius = -R, .thickness = R / (n - 1), .conic = -n * n}});
    const optics::SurfaceShape<double> rear{.curvature = -1 / R, .conic = -n * n};
    const double to_focus = R / (n - 1) - optics::sag(rear, 0.0, h);
    expect_relative(real_working_f_number(lens), 0.5 * std::hypot(h, to_focus) / h, 1e-13);
    expect_relative(optics::paraxial_data(lens).f_number, R / (n - 1) / (2 * h), 1e-13);
    // Turned round, with the object in its focus, it sends the light off parallel to the axis.
    const optics::TraceLens<double> reversed = lens_of<double>(
        {{.radius = R, .thickness = 12.0, .index = n, .conic = -n * n}, {.semi_diameter = h, .is_stop = true}});
    EXPECT_GT(real_working_f_number(reversed, R / (n - 1)), 1e14);
    expect_relative(optics::paraxial_conjugates(reversed, R / (n - 1)).object_numerical_aperture, h * (n - 1) / R,
                    1e-13);
}

// The same formulas in 50 digits, from the same doubles. Ten to thirty surfaces of rounding, and the cancellation in a
// retrofocus lens or a zoom, leave 1e-10 of room many times over.
TEST(FirstOrder, DoubleAgreesWithFiftyDigits) {
    using Wide = boost::multiprecision::cpp_bin_float_50;
    for (const char* name :
         {"tessar", "petzval", "double-gauss-angenieux", "distagon-28", "triplet-cooke", "muller-fisheye",
          "nikkor-fisheye-10", "fisheye-220", "gyogyotto", "canon-zoom-70-200", "super-takumar-135"}) {
        const optics::TraceLens<double> lens = shipped(name);
        const optics::ParaxialData data = optics::paraxial_data(lens);
        const auto wide_lens = optics::convert_lens<Wide>(lens);
        const auto wide = optics::paraxial_data(wide_lens);
        const auto near = [&](double value, const Wide& expected, const char* what) {
            EXPECT_LE(abs(Wide(value) - expected), 1e-11 * abs(expected)) << name << " " << what;
        };
        near(data.efl, wide.efl, "efl");
        near(data.bfl, wide.bfl, "bfl");
        near(data.ffl, wide.ffl, "ffl");
        near(data.front_principal_z, wide.front_principal_z, "front principal point");
        near(data.rear_principal_z, wide.rear_principal_z, "rear principal point");
        near(data.entrance_pupil_z, wide.entrance_pupil_z, "entrance pupil");
        near(data.entrance_pupil_diameter, wide.entrance_pupil_diameter, "entrance pupil's diameter");
        near(data.exit_pupil_z, wide.exit_pupil_z, "exit pupil");
        near(data.exit_pupil_diameter, wide.exit_pupil_diameter, "exit pupil's diameter");
        near(data.f_number, wide.f_number, "f-number");
        near(data.petzval_radius, wide.petzval_radius, "Petzval radius");
        near(optics::lagrange_invariant(lens, 0.7).value(), optics::lagrange_invariant(wide_lens, 0.7).value(),
             "Lagrange invariant");
        for (const double distance : {1e-3, 1.0, 1000.0, 1e15}) {
            const optics::Conjugates conjugates = optics::paraxial_conjugates(lens, distance);
            const auto wide_conjugates = optics::paraxial_conjugates(wide_lens, distance);
            near(conjugates.image_distance, wide_conjugates.image_distance, "image distance");
            near(conjugates.magnification, wide_conjugates.magnification, "magnification");
            near(conjugates.working_f_number, wide_conjugates.working_f_number, "working f-number");
            near(conjugates.object_numerical_aperture, wide_conjugates.object_numerical_aperture, "object NA");
        }
    }
}

}  // namespace lensproof::analysis::first_order_test
