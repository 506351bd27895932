// tests/experiments/studies/tradeoff/field_probe_test.cpp — where a model's light lands, against closed forms.
#include "experiments/studies/tradeoff/field_probe.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace lensproof::studies::field_probe_test {

using render::Camera;
using render::CameraSettings;
using render::LensModel;

CameraSettings thin_lens(double focal_length_mm, double f_number) {
    CameraSettings settings;
    settings.model = LensModel::thin_lens;
    settings.focal_length_mm = focal_length_mm;
    settings.f_number = f_number;
    settings.focus_distance_mm = std::numeric_limits<double>::infinity();
    settings.sensor = {.width = 90, .height = 60, .pixel_pitch_mm = 0.4};
    settings.exposure = {.time_s = 0.01, .iso = 100.0};
    settings.response = "cie-1931";
    return settings;
}

const render::SpectralSampling kBand{.layers = 8, .strata_per_layer = 1};

struct Ready {
    explicit Ready(const CameraSettings& settings) : camera(settings, kBand, render::PixelFilter{}, Cache(), true) {}
    Camera camera;
};

// A lens of 1 % more focal length images a star 1 % farther from the axis: all rays of it, without blur. At one
// f-number its light is cos⁴ of an angle that is as much smaller: below 0.02 EV at 22°.
TEST(FieldProbe, AnotherFocalLengthIsAnotherScale) {
    const Ready exact(thin_lens(50.0, 4.0));
    const Ready model(thin_lens(50.5, 4.0));
    const std::vector<ProbePoint> points = probe_points(exact.camera, 24);
    ASSERT_GE(points.size(), 20U);
    const FieldErrors found = field_errors(exact.camera, model.camera, points, {.rays = 64});
    const double half_diagonal_px = std::hypot(45.0, 30.0);
    for (std::size_t i = 0; i < points.size(); ++i) {
        // The point is one of the pixel's, whose middle is at most 0.71 px away.
        EXPECT_NEAR(found.at[i].image_px.value, 0.01 * points[i].image_height * half_diagonal_px, 0.0071 + 1e-9);
        EXPECT_NEAR(found.at[i].position_um.value, 400.0 * found.at[i].image_px.value, 1e-6);
        EXPECT_NEAR(found.at[i].blur_px.value, 0.0, 1e-6);
        EXPECT_NEAR(found.at[i].exposure_ev.value, 0.0, 0.02);
    }
    EXPECT_EQ(found.lost, 0.0);
}

// A stop wider by √2 gives twice the light and, in focus, nothing else.
TEST(FieldProbe, AStopIsAnExposure) {
    const Ready exact(thin_lens(50.0, 4.0));
    const Ready model(thin_lens(50.0, 4.0 / std::sqrt(2.0)));
    const FieldErrors found = field_errors(exact.camera, model.camera, probe_points(exact.camera, 24), {.rays = 64});
    // cos⁴ is not quite even over the wider pupil.
    EXPECT_NEAR(found.frame.exposure_ev.value, 1.0, 0.02);
    EXPECT_LT(found.frame.image_px.value, 1e-6);
}

// Seen from a pinhole the image of a lens's point is as wide as the lens makes it: focused at 2 m, a star is a disc of
// the diameter f/N · f/(s − f), whose rms radius is that over √8. A thin lens is no aplanat: across its pupil, f/8 to
// each side, light varies as cos⁴, by 4 tan θ/8 at most, which moves a disc's centre by an eighth of that of its
// diameter.
TEST(FieldProbe, APinholeHasNoBlur) {
    CameraSettings near_focus = thin_lens(50.0, 4.0);
    near_focus.focus_distance_mm = 2000.0;
    CameraSettings pinhole = near_focus;
    pinhole.model = LensModel::pinhole;
    const Ready exact(near_focus);
    const Ready model(pinhole);
    std::vector<ProbePoint> stars = probe_points(exact.camera, 12);
    for (ProbePoint& star : stars) {
        star.origin = {.at = (-1.0 / std::sqrt(dot(star.origin.at, star.origin.at))) * star.origin.at, .is_far = true};
    }
    const FieldErrors found = field_errors(exact.camera, model.camera, stars, {.rays = 1024});
    const double disc_px = 50.0 / 4.0 * 50.0 / (2000.0 - 50.0) / 0.4;
    for (const FieldError& at : found.at) {
        EXPECT_NEAR(at.blur_px.value, -disc_px / std::sqrt(8.0), 0.01 * disc_px);
        EXPECT_NEAR(at.position_um.value, 400.0 * disc_px / std::sqrt(8.0), 4.0 * disc_px);
        EXPECT_LT(at.image_px.value, 4.0 * 0.43 / 8.0 / 8.0 * disc_px);
    }
}

// A star out of focus is a disc of the diameter d, which leaves 2 J₁(x)/x of lines, x = π d/2 px at the pixels' Nyquist
// frequency; its pinhole's point leaves all of them. The light's cos⁴ over the pupil varies by 0.2, and its square
// changes a modulus by less than a hundredth.
TEST(FieldProbe, OutOfFocusThePinholesMtfIsTooHighByTheDiscs) {
    CameraSettings near_focus = thin_lens(50.0, 4.0);
    near_focus.focus_distance_mm = 1200.0;
    CameraSettings pinhole = near_focus;
    pinhole.model = LensModel::pinhole;
    const Ready exact(near_focus);
    const Ready model(pinhole);
    std::vector<ProbePoint> stars = probe_points(exact.camera, 12);
    for (ProbePoint& star : stars) {
        star.origin = {.at = (-1.0 / std::sqrt(dot(star.origin.at, star.origin.at))) * star.origin.at, .is_far = true};
    }
    const FieldErrors found = field_errors(exact.camera, model.camera, stars, {.rays = 1024});
    const double x = 0.5 * std::numbers::pi * 50.0 / 4.0 * 50.0 / (1200.0 - 50.0) / 0.4;
    const double expected = 1.0 - 2.0 * std::cyl_bessel_j(1.0, x) / x;
    ASSERT_GT(expected, 0.2);
    for (const FieldError& at : found.at) {
        EXPECT_NEAR(at.mtf_tangential.value, expected, 0.01);
        EXPECT_NEAR(at.mtf_sagittal.value, expected, 0.01);
    }
    EXPECT_NEAR(found.frame.mtf.value, expected, 0.01);
}

TEST(FieldProbe, TheLensItselfHasNoError) {
    CameraSettings settings = thin_lens(50.0, 4.0);
    settings.focal_length_mm.reset();
    settings.lens = "tessar";
    settings.model = LensModel::exact;
    settings.f_number = 6.3;
    const Ready exact(settings);
    const FieldErrors found = field_errors(exact.camera, exact.camera, probe_points(exact.camera, 12), {.rays = 32});
    EXPECT_EQ(found.frame.position_um.value, 0.0);
    EXPECT_EQ(found.frame.image_px.value, 0.0);
    EXPECT_EQ(found.frame.exposure_ev.value, 0.0);
    EXPECT_EQ(found.frame.mtf.value, 0.0);
    EXPECT_EQ(found.lost, 0.0);
}

}  // namespace lensproof::studies::field_probe_test
