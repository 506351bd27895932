// Vignetting, relative illumination and distortion where they have closed forms, and etendue.
#include "engine/analysis/field_light.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "engine/analysis/distortion.h"
#include "engine/analysis/field_curves.h"
#include "engine/base/angle.h"
#include "engine/formats/prescription/load_lens.h"
#include "engine/optics/illumination.h"
#include "engine/spectral/wavelengths.h"
#include "tests/engine/analysis/analysis_lens.h"

namespace lensproof::analysis::field_light_test {

optics::Lens bare_stop(double radius, double distance) {
    return made_of({{.thickness_mm = distance, .semi_diameter_mm = radius, .is_stop = true}});
}

/// A ball of glass with a stop at its centre, the sensor `image` mm behind the centre.
constexpr double kBall = 10.0;
constexpr double kIndex = 1.5;
optics::Lens ball(double stop, double image) {
    return made_of({{.radius_mm = kBall, .thickness_mm = kBall, .semi_diameter_mm = 9.99, .medium = {.n_d = kIndex}},
                    {.thickness_mm = kBall, .semi_diameter_mm = stop, .medium = {.n_d = kIndex}, .is_stop = true},
                    {.radius_mm = -kBall, .thickness_mm = image - kBall, .semi_diameter_mm = 9.99}});
}

// The projected solid angle of a disc of radius a in a parallel plane at h, seen from r beside its axis, is π times the
// view factor ½ (1 − (1 + H² − R²) / √(Z² − 4 R²)), H = h / r, R = a / r, Z = 1 + H² + R² (Howell, A Catalog of
// Radiation Heat Transfer Configuration Factors, B-13). Large stops, small ones, steep angles.
TEST(FieldLight, DiscSeenFromAPlane) {
    for (const double radius : {0.01, 3.0, 40.0}) {
        constexpr double kDistance = 50.0;
        const optics::Lens lens = bare_stop(radius, kDistance);
        const optics::TraceLens<double> traced = optics::at_wavelength<double>(lens, spectral::kLineD);
        const double on_axis = kPi * radius * radius / (kDistance * kDistance + radius * radius);
        EXPECT_NEAR(optics::image_outline(traced, {}).area / on_axis, 1.0, 1e-12);
        for (const double at : {1.0, 20.0, 100.0, 300.0}) {
            const long double H = kDistance / at;
            const long double R = radius / at;
            const long double Z = 1 + H * H + R * R;
            const long double expected = kPi / 2 * (1 - (1 + H * H - R * R) / std::sqrt(Z * Z - 4 * R * R));
            const double area = optics::image_outline(traced, {0.0, at}).area;
            // The outline's own 1e-11, and a few ulps of the direction cosines over the disc's width in them.
            const double width = radius * kDistance * kDistance / std::pow(std::hypot(kDistance, at), 3);
            const double tolerance = 1e-11 + 1e-15 / width;
            EXPECT_NEAR(area / static_cast<double>(expected), 1.0, tolerance) << radius << " " << at;
            // The same whichever way the point lies, by the half outline and by the whole one.
            EXPECT_NEAR(optics::image_outline(traced, {at * std::sin(0.7), at * std::cos(0.7)}).area / area, 1.0,
                        tolerance);
        }
    }
}

// A small stop obeys cos⁴ θ, and its beam cos θ; what is left is of the order of (a / h)², 4e-8.
TEST(FieldLight, SmallStopObeysTheCosineLaws) {
    const ColourOfLens d(bare_stop(0.01, 50.0), spectral::kLineD);
    const std::vector<double> fields = {0.0, 0.3, 0.8, 1.3};
    const std::vector<IlluminationPoint> curve = illumination_curve(d, d, fields);
    ASSERT_EQ(curve.size(), fields.size());
    for (const IlluminationPoint& point : curve) {
        EXPECT_NEAR(point.light.vignetting / std::cos(point.field_angle), 1.0, 1e-11);
        EXPECT_NEAR(point.light.relative_illumination / std::pow(std::cos(point.field_angle), 4), 1.0, 2e-7);
        EXPECT_NEAR(point.image_height, 50.0 * std::tan(point.field_angle), 1e-10);
    }
}

// What enters arrives: ∫ beam area dΩ over the directions is ∫ projected solid angle dA over the sensor's plane, all
// aberrations, pupil aberration and vignetting included (etendue in air on both sides). Gauss-Legendre with 4 nodes on
// each of 24 intervals; where light ends and where a rim starts to cut, the integrands have kinks, which cost
// about 1e-5.
TEST(FieldLight, EtendueIsConserved) {
    for (const char* name : {"tessar", "triplet-cooke"}) {
        const ColourOfLens d(formats::load_lens(name), spectral::kLineD);
        const optics::GaussRule rule = optics::gauss_legendre(4);
        constexpr int kIntervals = 24;
        const auto integral = [&](double end, const auto& integrand) {
            double sum = 0.0;
            for (int i = 0; i < kIntervals; ++i) {
                for (std::size_t k = 0; k < rule.nodes.size(); ++k) {
                    sum += end / kIntervals * rule.weights[k] * integrand(end * (i + rule.nodes[k]) / kIntervals);
                }
            }
            return sum;
        };
        const double end = d.chief_rays.largest_field();
        double image_end = 0.0;  // beyond the last height that light reaches
        const double entering = integral(end, [&](double field) {
            const optics::FieldBundle bundle = optics::field_bundle(d.chief_rays, field).value();
            image_end = std::max(image_end, 1.1 * bundle.chief.image_height);
            return 2.0 * kPi * std::sin(field) * beam_outline(d.lens, bundle).area;
        });
        EXPECT_EQ(optics::image_outline(d.lens, {0.0, image_end}).area, 0.0);
        const double arriving = integral(image_end, [&](double height) {
            return 2.0 * kPi * height * optics::image_outline(d.lens, {0.0, height}).area;
        });
        EXPECT_NEAR(arriving / entering, 1.0, 1e-4) << name;
    }
}

// A lens turned as a whole about x sees the beam of the field that the turn makes of it, and turned about its own axis
// the same one, although no half of the outline stands for the other any more.
TEST(FieldLight, TurnedLensSeesTheTurnedBeam) {
    constexpr double kTilt = radians(5.0);
    const auto light = [](std::array<double, 3> tilt_deg, double field) {
        optics::Prescription prescription;
        optics::PrescribedSurface front{
            .radius_mm = 40.0, .thickness_mm = 5.0, .semi_diameter_mm = 9.0, .medium = {.n_d = 1.6}};
        prescription.surfaces = {front,
                                 {.radius_mm = 300.0, .thickness_mm = 6.0, .semi_diameter_mm = 9.0},
                                 {.thickness_mm = 60.0, .semi_diameter_mm = 7.0, .is_stop = true}};
        prescription.groups = {{.first = 1, .last = 3, .misalignment = {.tilt_deg = tilt_deg}}};
        const ColourOfLens d(optics::make_lens(prescription, {}), spectral::kLineD);
        const optics::FieldBundle bundle = optics::field_bundle(d.chief_rays, field).value();
        return field_light(d.lens, bundle, bundle.chief.image_point);
    };
    const FieldLight straight = light({}, 0.3);
    const FieldLight about_axis = light({0.0, 0.0, 33.0}, 0.3);
    EXPECT_TRUE(straight.beam.is_half);
    EXPECT_FALSE(about_axis.beam.is_half);
    EXPECT_NEAR(about_axis.beam.area / straight.beam.area, 1.0, 1e-10);
    EXPECT_NEAR(about_axis.image.area / straight.image.area, 1.0, 1e-10);
    // About x, by the right-hand rule, the axis goes from +z towards −y: the field angle to it grows by the tilt.
    const FieldLight about_x = light({5.0, 0.0, 0.0}, 0.3 - kTilt);
    EXPECT_NEAR(about_x.beam.area / straight.beam.area, 1.0, 1e-10);
    const FieldLight about_y = light({0.0, 5.0, 0.0}, 0.0);
    EXPECT_NEAR(about_y.beam.area / light({}, kTilt).beam.area, 1.0, 1e-10);
}

// Through the ball's centre chief rays go straight: h = L tan θ at L behind it, with the focal length n R / (2 (n −
// 1)). At L = f nothing is distorted; the other projections are off by their own law; a near object is imaged without
// distortion at its own paraxial image.
TEST(Distortion, BallLens) {
    constexpr double kFocal = kIndex * kBall / (2.0 * (kIndex - 1.0));
    const ColourOfLens far(ball(1.0, kFocal), spectral::kLineD);
    constexpr double kObject = 90.0;  // in front of the vertex: s = −100 from the centre
    const double near_image = 1.0 / (1.0 / kFocal - 1.0 / (kObject + kBall));
    const ColourOfLens near(ball(1.0, near_image), spectral::kLineD);
    for (const double field : {0.0, 1e-6, 0.4, 1.2}) {
        const optics::FieldBundle bundle = optics::field_bundle(far.chief_rays, field).value();
        EXPECT_NEAR(distortion_percent(far.lens, optics::Projection::rectilinear, bundle, far.lens.image_z).value(),
                    0.0, 1e-10);
        const optics::FieldBundle near_bundle = optics::field_bundle(near.chief_rays, field, kObject).value();
        EXPECT_NEAR(
            distortion_percent(near.lens, optics::Projection::rectilinear, near_bundle, near.lens.image_z).value(), 0.0,
            1e-10);
        if (field < 0.1) {
            continue;
        }
        const std::pair<optics::Projection, double> laws[] = {
            {optics::Projection::equidistant, field},
            {optics::Projection::equisolid, 2.0 * std::sin(0.5 * field)},
            {optics::Projection::stereographic, 2.0 * std::tan(0.5 * field)},
            {optics::Projection::orthographic, std::sin(field)}};
        for (const auto& [projection, radius] : laws) {
            const double expected = 100.0 * (std::tan(field) / radius - 1.0);
            EXPECT_NEAR(distortion_percent(far.lens, projection, bundle, far.lens.image_z).value(), expected, 1e-10);
            // −m (d + z_E) is what is left of f: the image's distance from the ball's centre, where the pupils are.
            EXPECT_NEAR(distortion_percent(near.lens, projection, near_bundle, near.lens.image_z).value(), expected,
                        1e-10);
        }
    }
    EXPECT_EQ(distortion_percent(far.lens, optics::Projection::rectilinear,
                                 {.chief = far.chief_rays.at_field(0.0).value()}, kFocal),
              0.0);
}

// A sensor out of focus neither moves the curve's start from 0 nor changes it: the Tessar's is that in its paraxial
// image plane, to what h_ideal's own digits leave at a field of 1e-4.
TEST(Distortion, IsOfTheParaxialImagePlane) {
    optics::Lens lens = formats::load_lens("tessar");
    const ColourOfLens in_focus(lens, spectral::kLineD);
    lens.image_z += 2.0;
    const ColourOfLens out_of_focus(lens, spectral::kLineD);
    const auto at = [&](const ColourOfLens& colour, double field) {
        const auto bundle = optics::field_bundle(colour.chief_rays, field).value();
        return distortion_percent(colour.lens, lens.projection, bundle, distortion_plane(colour.lens, kInfinity))
            .value();
    };
    EXPECT_NEAR(at(out_of_focus, 1e-4), 0.0, 1e-6);
    EXPECT_NEAR(at(out_of_focus, 0.4), at(in_focus, 0.4), 1e-9);
    EXPECT_LT(at(out_of_focus, 0.4), -0.1);
}

// Beyond 90° there is no rectilinear height; the fisheye's own law has one.
TEST(Distortion, BehindTheLens) {
    const optics::Lens lens = formats::load_lens("fisheye-220");
    const ColourOfLens d(lens, spectral::kLineD);
    for (const double degrees : {90.0, 105.0}) {
        const optics::FieldBundle bundle = optics::field_bundle(d.chief_rays, radians(degrees)).value();
        EXPECT_FALSE(distortion_percent(d.lens, optics::Projection::rectilinear, bundle, d.lens.image_z));
        EXPECT_LT(std::abs(distortion_percent(d.lens, lens.projection, bundle, d.lens.image_z).value()), 5.0);
    }
}

}  // namespace lensproof::analysis::field_light_test
