// Cameras without aberrations against the formulas that define them, and against the lens that they stand for.
#include "engine/render/camera/ideal_camera.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "engine/base/angle.h"
#include "engine/formats/prescription/load_lens.h"
#include "engine/optics/focus.h"
#include "engine/optics/illumination.h"
#include "engine/optics/paraxial.h"
#include "engine/spectral/wavelengths.h"

namespace lensproof::ideal_camera_test {

struct Drawn {
    double irradiance = 0.0;  // in a world of radiance 1
    double mean_x_at = 0.0;
    double rms_x_at = 0.0;
};

/// Of one pixel's paths; `at_mm`: the distance in front of the first vertex at which their x is looked at.
Drawn draw(const render::GaussianOptics& optics, const render::Sensor& sensor, std::uint32_t pixel, double at_mm) {
    constexpr std::uint32_t kSamples = 1U << 14U;
    const render::IdealCamera camera({optics});
    render::IdealCamera::Paths drawn(camera, {.sensor = sensor, .seed = 5}, {}, render::PathCarry::hero);
    render::CameraPathBuffer paths;
    drawn.start({.first_pixel = pixel, .pixels = 1, .first_sample = 0, .samples = kSamples});
    Drawn found;
    double squares = 0.0;
    while (drawn.fill(paths)) {
        for (std::size_t i = 0; i < static_cast<std::size_t>(paths.size); ++i) {
            const Ray<double> ray = paths.ray(i);
            const double x = ray.origin.x + (-at_mm - ray.origin.z) / ray.direction.z * ray.direction.x;
            found.irradiance += paths.weight[i] / kSamples;
            found.mean_x_at += x / kSamples;
            squares += x * x / kSamples;
        }
    }
    found.rms_x_at = std::sqrt(squares - found.mean_x_at * found.mean_x_at);
    return found;
}

optics::Lens double_gauss(double f_number, double focus_mm) {
    return optics::focused_at(optics::with_f_number(formats::load_lens("double-gauss-tronnier"), f_number), focus_mm);
}

/// A sensor of one small pixel a column, `columns` of them over `width_mm`.
render::Sensor small_pixels(double width_mm, int columns) {
    return {.width = columns, .height = 1, .pixel_pitch_mm = width_mm / columns};
}

// A pinhole gives τ A cos⁴θ / s'² in a world of radiance 1, A being its opening's area; a thin lens on its axis
// τ π sin²u, and that is τ π / (4 N²) for tan u = 1 / (2 N). Sampling of the disc is even, so 2^14 points of a
// scrambled sequence err by less than 1e-4 (seen: 2e-6).
TEST(IdealCamera, ExposesByItsFNumber) {
    const optics::Lens lens = double_gauss(4.0, 1e9);
    const optics::TraceLens<double> traced = optics::at_wavelength<double>(lens, spectral::kLineD);
    const double efl = optics::paraxial_data(traced).efl;
    const render::Sensor sensor = small_pixels(40.0, 401);
    const render::GaussianOptics pinhole = render::gaussian_optics(lens, render::LensModel::pinhole, spectral::kLineD);
    const render::GaussianOptics thin = render::gaussian_optics(lens, render::LensModel::thin_lens, spectral::kLineD);
    const double area = kPi * std::pow(efl / 4.0 / 2.0, 2);
    for (const std::uint32_t column : {200U, 300U, 400U}) {
        const double x = sensor.position(column, 0.0).x;
        const double cos2 = efl * efl / (efl * efl + x * x);
        EXPECT_NEAR(draw(pinhole, sensor, column, 1e6).irradiance,
                    pinhole.transmittance * area * cos2 * cos2 / (efl * efl), 1e-4 * area / (efl * efl));
    }
    const double sin2 = 1.0 / (1.0 + 4.0 * 4.0 * 4.0);
    EXPECT_NEAR(draw(thin, sensor, 200, 1e6).irradiance, thin.transmittance * kPi * sin2, 1e-4 * kPi * sin2);
}

// With one f-number every model gives the exposure that the lens itself has on its axis. At f/4 the lens's own beam
// differs from its paraxial one by pupil aberration of a part in a hundred.
TEST(IdealCamera, ModelsExposeAlike) {
    const optics::Lens lens = double_gauss(4.0, 1e9);
    const double exact = optics::image_bundle(optics::at_wavelength<double>(lens, spectral::kLineD), 0.0).transmitted;
    for (const render::LensModel model :
         {render::LensModel::paraxial, render::LensModel::thin_lens, render::LensModel::pinhole}) {
        const double found =
            draw(render::gaussian_optics(lens, model, spectral::kLineD), small_pixels(0.1, 1), 0, 1e6).irradiance;
        EXPECT_NEAR(found / exact, 1.0, 0.03) << static_cast<int>(model);
    }
}

// A thin lens of focal length f and diameter D, focused on d, blurs a point at d₂ to a disc whose diameter, seen in the
// plane d₂, is D |d₂ − d| / d (similar triangles from the lens). The film point's rays cross d₂ evenly over that disc:
// their rms in x is its diameter over 4. Distances count from the lens, at the front principal plane.
TEST(IdealCamera, ThinLensBlursByItsFormula) {
    constexpr double kFocus = 2000.0;
    const optics::Lens lens = double_gauss(2.0, kFocus);
    const optics::TraceLens<double> traced = optics::at_wavelength<double>(lens, spectral::kLineD);
    const optics::ParaxialData data = optics::paraxial_data(traced);
    const render::GaussianOptics thin = render::gaussian_optics(lens, render::LensModel::thin_lens, spectral::kLineD);
    const render::GaussianOptics pinhole = render::gaussian_optics(lens, render::LensModel::pinhole, spectral::kLineD);
    const render::GaussianOptics paraxial =
        render::gaussian_optics(lens, render::LensModel::paraxial, spectral::kLineD);
    const render::Sensor sensor = small_pixels(1e-4, 1);
    for (const double distance : {500.0, 1500.0, 2000.0, 3000.0, 20000.0}) {
        const double from_lens = distance + data.front_principal_z;
        const double focus = kFocus + data.front_principal_z;
        const double blur = data.entrance_pupil_diameter * std::abs(from_lens - focus) / focus;
        // A pixel of 0.1 µm is seen as 2e-3 mm at most here; where the blur vanishes that is all there is.
        EXPECT_NEAR(draw(thin, sensor, 0, distance).rms_x_at, blur / 4.0, 1e-3 * blur + 1e-2) << distance;
        EXPECT_LT(draw(pinhole, sensor, 0, distance).rms_x_at, 0.05) << distance;
        // The lens's own pupil stands elsewhere than its principal plane, and its diameter is seen from there.
        const double from_pupil = distance + data.entrance_pupil_z;
        const double focus_from_pupil = kFocus + data.entrance_pupil_z;
        const double own = data.entrance_pupil_diameter * std::abs(from_pupil - focus_from_pupil) / focus_from_pupil;
        EXPECT_NEAR(draw(paraxial, sensor, 0, distance).rms_x_at, own / 4.0, 1e-3 * own + 1e-2) << distance;
    }
}

// The paraxial camera looks where the lens's own chief rays look, as far as those are paraxial: at 1 mm from the axis
// to the third-order distortion of a part in 1e4; thin lens and pinhole, whose pupil stands in the principal plane, see
// the far world in the same directions.
TEST(IdealCamera, LooksWhereTheLensLooks) {
    const optics::Lens lens = double_gauss(8.0, 1e9);
    const double efl = optics::paraxial_data(optics::at_wavelength<double>(lens, spectral::kLineD)).efl;
    const render::Sensor sensor = small_pixels(2.001, 2001);
    const double x = sensor.position(2000.0, 0.0).x;
    EXPECT_NEAR(x, -1.0, 1e-12);
    for (const render::LensModel model :
         {render::LensModel::paraxial, render::LensModel::thin_lens, render::LensModel::pinhole}) {
        const Drawn seen = draw(render::gaussian_optics(lens, model, spectral::kLineD), sensor, 2000, 1e9);
        EXPECT_NEAR(seen.mean_x_at / 1e9, 1.0 / efl, 1e-5 / efl) << static_cast<int>(model);
    }
}

}  // namespace lensproof::ideal_camera_test
