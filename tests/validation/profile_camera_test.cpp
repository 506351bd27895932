// Cameras that know of a lens its chief rays and its light alone, against the lens and against their own etendue.
#include "engine/render/camera/profile_camera.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "engine/base/angle.h"
#include "engine/base/infinity.h"
#include "engine/formats/prescription/load_lens.h"
#include "engine/optics/chief_ray.h"
#include "engine/optics/focus.h"
#include "engine/optics/illumination.h"
#include "engine/optics/paraxial.h"
#include "engine/render/camera/camera.h"
#include "engine/spectral/wavelengths.h"
#include "tests/complaint.h"

namespace lensproof::profile_camera_test {

optics::Lens lens_at(const std::string& name, double f_number, double focus_mm) {
    return optics::focused_at(optics::with_f_number(formats::load_lens(name), f_number), focus_mm);
}

const std::vector<double> kWavelengths = spectral::WavelengthStrata{400.0, 700.0, 16}.midpoints();

struct Setting {
    const char* lens;
    double f_number;
    double film_radius_mm;
};

// What they cover, to the corners, and of the fisheyes beyond the light's end.
constexpr Setting kSettings[] = {
    {"tessar", 2.8, 45.0},      {"double-gauss-tronnier", 2.0, 21.6}, {"petzval", 2.2, 22.5},
    {"canon-fd-24", 2.8, 21.6}, {"wide-nakamura", 8.0, 17.0},         {"muller-fisheye", 8.0, 14.0},
    {"fisheye-220", 8.0, 12.5},
};

// Between the nodes the profile is the lens: the chief ray of the field that it names meets the film at the radius that
// it was asked for, and the light is that of the bundle there. Heights to 0.1 nm: h⁴ f⁗ / 384 of 128 steps. Light to
// 1e-3 of that on the axis where rims set in gently; the Müller fisheye's slope jumps from −1 to −10 of it a radius,
// over which the steps of 1/40 err by h/8 of the jump at most. Within the last 0.5 % of the radius, where a fisheye's
// whole pupil is cut off, a step of 1/512 has a third of the fall.
TEST(LensProfile, IsTheLensBetweenItsNodes) {
    for (const auto& [name, f_number, film_radius] : kSettings) {
        const optics::Lens lens = lens_at(name, f_number, 1e6);
        const render::LensProfile profile = render::traced_profile(lens, kWavelengths, film_radius);
        double worst_um = 0.0;
        double worst_light = 0.0;
        double worst_edge = 0.0;
        double worst_end = 0.0;
        for (const std::size_t k : {0U, 3U, 15U}) {
            const optics::ChiefRays chiefs(lens, kWavelengths[k], optics::Rims::follow);
            const optics::TraceLens<double> traced = optics::at_wavelength<double>(lens, kWavelengths[k]);
            const render::RadialProfile& at = profile.at[k];
            const double end = at.field_angle.end();
            const double axis = optics::image_bundle(traced, 0.0).transmitted;
            EXPECT_EQ(at.illumination.end(), end);
            for (int i = 0; i < 101; ++i) {
                const double r = end * (i + 0.61) / 101.0;
                const auto chief = chiefs.at_field(at.field_angle.at(r).value);
                ASSERT_TRUE(chief.has_value()) << name << ", " << r;
                worst_um = std::max(worst_um, 1e3 * std::abs(chief->image_height - r));
                const double light = optics::image_bundle(traced, r).transmitted;
                double& worst = r < 0.995 * end ? worst_light : worst_edge;
                worst = std::max(worst, std::abs(at.illumination.at(r).value - light) / axis);
            }
            if (end < 0.99 * film_radius) {
                worst_end = std::max(worst_end, optics::image_bundle(traced, 1.001 * end).transmitted / axis);
            }
        }
        fmt::print("{}: chief rays to {:.2g} um, light to {:.2g} of the axis's, {:.2g} at its end, beyond it {:.2g}\n",
                   name, worst_um, worst_light, worst_edge, worst_end);
        EXPECT_LT(worst_um, 1e-4) << name;
        EXPECT_LT(worst_light, film_radius > 15.0 ? 1e-3 : 4e-3) << name;
        EXPECT_LT(worst_edge, 0.03) << name;
        EXPECT_EQ(worst_end, 0.0) << name;
    }
}

render::ProfileCamera camera_of(const optics::Lens& lens, double film_radius_mm, bool is_pinhole, double focus_mm) {
    return {render::traced_profile(lens, kWavelengths, film_radius_mm),
            {.is_pinhole = is_pinhole, .focus_z = -focus_mm}};
}

constexpr render::Sensor kOnAxis{.width = 1, .height = 1, .pixel_pitch_mm = 1.0};

/// The film point that a ray into the camera meets, mm.
Vec2d film_of(const render::FilmImportance& film, std::size_t i) {
    return kOnAxis.position(film.at_px[i].x, film.at_px[i].y);
}

// The pinhole's image of a point lies where the lens's own chief ray from there lies: exactly, of far points, but for
// the curves' 0.1 nm; of near ones by the parallax of the pupil, which is that of one line for all wavelengths: a pupil
// that lies δ beside its own wavelength's moves the image by δ sin θ / t · dr/dθ, to second order in δ.
TEST(ProfileCamera, PinholeSeesWhatChiefRaysSee) {
    const spectral::SpectralGrid grid{spectral::WavelengthStrata{400.0, 700.0, 16}};
    for (const auto& [name, f_number, film_radius] : kSettings) {
        const optics::Lens lens = lens_at(name, f_number, 2000.0);
        const render::ProfileCamera camera = camera_of(lens, film_radius, true, 2000.0);
        double worst_far = 0.0;
        double worst_near = 0.0;
        double worst_parallax = 0.0;
        int compared = 0;
        for (const std::uint16_t hero : {0, 1, 2, 3}) {
            const spectral::PathWavelengths path = grid.path(hero);
            for (std::size_t m = 0; m < spectral::kWavelengthsPerPath; ++m) {
                const optics::ChiefRays chiefs(lens, kWavelengths[path.index[m]], optics::Rims::follow);
                const render::RisingCurve& angles = camera.profile().at[path.index[m]].field_angle;
                const double field = angles.at(angles.end()).value;
                for (const double part : {0.05, 0.3, 0.6, 0.9, 0.99}) {
                    const double angle = part * field;
                    const Vec3d far{0.0, std::sin(angle), std::cos(angle)};
                    const Vec3d near = Vec3d{0.0, 0.0, 0.0} - 2000.0 * far;
                    const auto of_far = chiefs.at_field(angle);
                    const auto of_near = chiefs.from_point(near);
                    const double slope = angles.where(angle).value().slope;
                    if (!of_far || !of_near) {
                        continue;
                    }
                    const auto in_far = camera.sample({far, true}, path, 0.5, 0.5);
                    const auto in_near = camera.sample({near, false}, path, 0.5, 0.5);
                    if (!in_far || !in_near) {
                        continue;  // dark for the hero
                    }
                    const render::FilmImportance film_far = camera.importance(kOnAxis, in_far->ray, path);
                    const render::FilmImportance film_near = camera.importance(kOnAxis, in_near->ray, path);
                    if (film_far.transmittance[m] == 0.0 || film_near.transmittance[m] == 0.0) {
                        continue;
                    }
                    worst_far = std::max(worst_far, std::abs(film_of(film_far, m).y - of_far->image_height));
                    const auto& [start, direction] = of_near->front;
                    const double own_z = start.z - start.y * direction.z / direction.y;
                    const double off = own_z - camera.profile().pupil_z.at(of_near->field_angle).value;
                    const double parallax = std::abs(off * direction.y) / (length(near) * slope);
                    const double near_off = std::abs(film_of(film_near, m).y - of_near->image_height);
                    EXPECT_LT(near_off, 1.1 * parallax + 1e-4) << name << ", " << angle;
                    worst_near = std::max(worst_near, near_off);
                    worst_parallax = std::max(worst_parallax, parallax);
                    ++compared;
                }
            }
        }
        fmt::print("{}: {} points, far {:.2g} um, at 2 m {:.2g} um, parallax {:.2g} um\n", name, compared,
                   1e3 * worst_far, 1e3 * worst_near, 1e3 * worst_parallax);
        EXPECT_GT(compared, 60) << name;
        EXPECT_LT(worst_far, 1e-7) << name;
    }
}

/// A thin lens without distortion, as a profile: tan θ = r / s', E as an ideal lens has it, the pupil in the lens.
render::LensProfile thin_profile(const render::GaussianOptics& thin) {
    constexpr int kNodes = 129;
    constexpr double kRadius = 22.0;
    std::vector<render::RadialCurve::At> angle;
    std::vector<render::RadialCurve::At> light;
    const double d = thin.film_z;
    for (int i = 0; i < kNodes; ++i) {
        const double r = kRadius * i / (kNodes - 1);
        const double cos2 = d * d / (d * d + r * r);
        const double on_axis = kPi * thin.pupil_radius_mm * thin.pupil_radius_mm / (d * d);
        angle.push_back({std::atan(r / d), cos2 / d});
        light.push_back({on_axis * cos2 * cos2, -4.0 * on_axis * cos2 * cos2 * cos2 * r / (d * d)});
    }
    return {.at = {{.field_angle = render::RisingCurve({kRadius, angle}),
                    .illumination = {kRadius, light},
                    .transmittance = 1.0}},
            .pupil_z = {1.0, std::vector<render::RadialCurve::At>(2)},
            .front_z = 0.0};
}

// With the profile of a thin lens it is that: the same film and pupil numbers make the same rays. They cross in the
// same point of the focus. At the pupil, the ellipse across the chief ray is the disc across the axis seen from far
// off: from a focus at t, a ray goes through points of both that are R sin θ · R / t apart, seen across. Weights agree
// in the mean; a thin lens's own vary over its pupil by 4 (R / s')².
TEST(ProfileCamera, WithAThinLensProfileIsAThinLens) {
    constexpr double kFocus = 1500.0;
    const render::GaussianOptics thin = render::gaussian_optics(50.0, 8.0, kFocus, render::LensModel::thin_lens);
    const render::IdealCamera ideal({thin});
    const render::ProfileCamera profile(thin_profile(thin), {.is_pinhole = false, .focus_z = -kFocus});
    const render::FilmSampling film{.sensor = {.width = 36, .height = 24, .pixel_pitch_mm = 1.0}, .seed = 3};
    const spectral::SpectralGrid grid{spectral::WavelengthStrata{500.0, 600.0, 4}};
    render::IdealCamera::Paths of_ideal(ideal, film, grid, render::PathCarry::hero);
    render::ProfileCamera::Paths of_profile(profile, film, grid, render::PathCarry::hero);
    const render::CameraPathRange all{.first_pixel = 0, .pixels = 36 * 24, .first_sample = 0, .samples = 16};
    of_ideal.start(all);
    of_profile.start(all);
    render::CameraPathBuffer a;
    render::CameraPathBuffer b;
    double worst_focus = 0.0;
    double worst_pupil = 0.0;
    double sum_a = 0.0;
    double sum_b = 0.0;
    while (of_ideal.fill(a)) {
        ASSERT_TRUE(of_profile.fill(b));
        ASSERT_EQ(a.size, b.size);
        for (std::size_t i = 0; i < static_cast<std::size_t>(a.size); ++i) {
            const auto at = [](const Ray<double>& ray, double z) {
                return ray.origin + (z - ray.origin.z) / ray.direction.z * ray.direction;
            };
            worst_focus = std::max(worst_focus, length(at(a.ray(i), -kFocus) - at(b.ray(i), -kFocus)));
            worst_pupil = std::max(worst_pupil, length(at(a.ray(i), 0.0) - at(b.ray(i), 0.0)));
            sum_a += a.weight[i];
            sum_b += b.weight[i];
        }
    }
    const double radius = thin.pupil_radius_mm;
    fmt::print("at the focus {:.2g} mm, at the pupil {:.2g} mm, light {:.6f}\n", worst_focus, worst_pupil,
               sum_b / sum_a);
    EXPECT_LT(worst_focus, 1e-6);  // of 650 mm off the axis; interpolation of the angle, 1e-10 rad
    const double largest_tan = std::hypot(18.0, 12.0) / thin.film_z;
    EXPECT_LT(worst_pupil, radius * largest_tan * radius / kFocus);
    EXPECT_NEAR(sum_b / sum_a, 1.0, 4.0 * std::pow(radius / thin.film_z, 2));
}

// ∫ dx dq / A over film and pupil is the film's area. Here from the other end: rays from everywhere outside, even in
// etendue, each with the pdf that the camera states for it; what lands in a ring of the film sums to the ring's area
// where its Jacobian is right, and only there. Close focus makes all of its terms count, and fisheyes look behind.
TEST(ProfileCamera, EtendueOutsideIsThatOfTheFilm) {
    struct Case {
        const char* lens;
        double f_number;
        double film_radius_mm;
        double focus_mm;
    };
    for (const auto& [name, f_number, film_radius, focus] :
         {Case{"double-gauss-tronnier", 2.0, 20.0, 400.0}, Case{"muller-fisheye", 4.0, 13.0, 200.0},
          Case{"fisheye-220", 8.0, 11.7, 1e6}}) {
        const optics::Lens lens = lens_at(name, f_number, focus);
        const render::ProfileCamera camera = camera_of(lens, film_radius, false, focus);
        const render::RisingCurve& angles = camera.profile().at[8].field_angle;
        const double end = angles.end();
        const double field = std::min(kPi, angles.at(end).value + 0.1);
        const spectral::PathWavelengths path{{8, 8, 8, 8}};
        std::mt19937_64 random(1);
        std::uniform_real_distribution<double> unit(0.0, 1.0);
        constexpr int kRings = 4;
        std::array<double, kRings> sum{};
        std::array<double, kRings> squares{};
        constexpr int kRays = 1'500'000;
        const optics::ParaxialData data = optics::paraxial_data(optics::at_wavelength<double>(lens, kWavelengths[8]));
        const double reach = 1.6 * data.entrance_pupil_diameter;
        const double solid_angle = 2.0 * kPi * (1.0 - std::cos(field));
        for (int i = 0; i < kRays; ++i) {
            const double cosine = 1.0 - unit(random) * (1.0 - std::cos(field));
            const double angle = std::acos(cosine);
            const double azimuth = 2.0 * kPi * unit(random);
            const Vec2d e{std::cos(azimuth), std::sin(azimuth)};
            const Vec3d inwards{std::sin(angle) * e.x, std::sin(angle) * e.y, cosine};
            // A disc about where this field's pupil stands, across the ray.
            const double z = camera.profile().pupil_z.at(std::min(angle, camera.profile().pupil_z.end())).value;
            const double r = reach * std::sqrt(unit(random));
            const double turn = 2.0 * kPi * unit(random);
            const Vec3d sagittal{-e.y, e.x, 0.0};
            const Vec3d start =
                Vec3d{0.0, 0.0, z} + r * std::cos(turn) * sagittal + r * std::sin(turn) * cross(inwards, sagittal);
            const render::FilmImportance film = camera.importance(kOnAxis, {start, inwards}, path);
            if (film.transmittance[0] > 0.0) {
                const double value = film.pdf[0] * solid_angle * kPi * reach * reach;
                const double ring = std::pow(length(film_of(film, 0)) / end, 2) * kRings;
                const auto at = static_cast<std::size_t>(std::min(kRings - 1.0, ring));
                sum[at] += value / kRays;
                squares[at] += value * value / kRays;
            }
        }
        for (std::size_t at = 0; at < kRings; ++at) {
            const double area = kPi * end * end / kRings;
            const double error = std::sqrt((squares[at] - sum[at] * sum[at]) / kRays);
            fmt::print("{}, ring {}: {:.4f} ± {:.4f} of its area\n", name, at, sum[at] / area, error / area);
            EXPECT_NEAR(sum[at], area, 4.0 * error) << name;
            EXPECT_LT(error, 0.02 * area);
        }
    }
}

// Of light from a point on a camera path, `sample` may draw that path, from any distance that it draws from at all:
// else light paths would lack what camera paths see. The film point of each is that where the path began.
TEST(ProfileCamera, LightPathsReachAllThatCameraPathsSee) {
    for (const auto& [name, f_number, film_radius] : {kSettings[1], kSettings[4], kSettings[5], kSettings[6]}) {
        for (const double focus : {300.0, kInfinity}) {
            const optics::Lens lens = lens_at(name, f_number, std::min(focus, 1e9));
            const render::ProfileCamera camera = camera_of(lens, film_radius, false, focus);
            const render::Sensor sensor{.width = 12, .height = 12, .pixel_pitch_mm = film_radius / 8.6};
            const spectral::SpectralGrid grid{spectral::WavelengthStrata{400.0, 700.0, 16}};
            render::ProfileCamera::Paths paths(camera, {.sensor = sensor, .seed = 4}, grid,
                                               render::PathCarry::wavelengths_and_pdfs);
            render::CameraPathBuffer buffer;
            paths.start({.first_pixel = 0, .pixels = 144, .first_sample = 0, .samples = 32});
            int looked = 0;
            double worst_film = 0.0;
            while (paths.fill(buffer)) {
                for (std::size_t i = 0; i < static_cast<std::size_t>(buffer.size); ++i) {
                    const Ray<double> out = buffer.ray(i);
                    const spectral::PathWavelengths path = grid.path(buffer.wavelength[i]);
                    const render::FilmImportance film =
                        camera.importance(sensor, {out.origin, -1.0 * out.direction}, path);
                    ASSERT_GT(film.pdf[0], 0.0);
                    const Vec2d at = sensor.position(film.at_px[0].x, film.at_px[0].y);
                    worst_film = std::max(worst_film, length(at - Vec2d{buffer.film_x[i], buffer.film_y[i]}));
                    EXPECT_NEAR(buffer.pdf[i].hero, film.pdf[0], 1e-6 * film.pdf[0]);
                    for (const double distance : {1.1 * camera.near_mm(), 2.5 * camera.near_mm(), 300.0, 3000.0}) {
                        const Vec3d at_distance = out.origin + distance * out.direction;
                        if (length(at_distance - Vec3d{0, 0, camera.profile().pupil_z.at(0.0).value}) >
                            camera.near_mm()) {
                            EXPECT_GT(camera.pdf({at_distance, false}, out, path).hero, 0.0) << name << distance;
                            ++looked;
                        }
                    }
                    EXPECT_GT(camera.pdf({-1.0 * out.direction, true}, out, path).hero, 0.0) << name;
                }
            }
            fmt::print("{} focused at {} mm: near {:.1f} mm, film points to {:.2g} mm\n", name, focus, camera.near_mm(),
                       worst_film);
            EXPECT_GT(looked, 4000);
            EXPECT_LT(worst_film, 1e-12);  // some ulps of 20 mm, made and found again
        }
    }
}

struct Seen {
    double irradiance = 0.0;
    double error = 0.0;
};

/// A pixel's, in a world of radiance 1, of all wavelengths.
Seen irradiance(const render::Camera& camera, std::uint32_t pixel, std::uint32_t samples) {
    render::CameraPaths paths = camera.paths(7, render::PathCarry::hero);
    render::CameraPathBuffer buffer;
    paths.start({.first_pixel = pixel, .pixels = 1, .first_sample = 0, .samples = samples});
    double sum = 0.0;
    double squares = 0.0;
    while (paths.fill(buffer)) {
        for (std::size_t i = 0; i < static_cast<std::size_t>(buffer.size); ++i) {
            sum += buffer.weight[i] / samples;
            squares += buffer.weight[i] * buffer.weight[i] / samples;
        }
    }
    return {sum, std::sqrt(std::max(0.0, squares - sum * sum) / samples)};
}

// In an even world a film point gets what the exact model gives it, on the axis and off: vignetting, cos⁴ and losses.
// 1e-3 of the axis's is the curve's, above, but in a fisheye's last pixel; the standard error is that of both, far
// above what so even samples err by.
TEST(ProfileCamera, ExposesAsTheLensDoes) {
    for (const Setting& setting : {kSettings[1], kSettings[2], kSettings[5], kSettings[6]}) {
        const char* name = setting.lens;
        const double f_number = setting.f_number;
        const double film_radius = setting.film_radius_mm;
        const render::Sensor sensor{
            .width = 41, .height = 1, .pixel_pitch_mm = 2.0 * film_radius / std::hypot(41.0, 1.0)};
        const auto camera = [&](render::LensModel model) {
            return std::make_unique<render::Camera>(render::CameraSettings{.lens = name,
                                                                           .f_number = f_number,
                                                                           .focus_distance_mm = 3000.0,
                                                                           .sensor = sensor,
                                                                           .response = "luminance",
                                                                           .model = model},
                                                    render::SpectralSampling{400.0, 700.0, 16, 1},
                                                    render::PixelFilter{}, Cache{});
        };
        const auto exact = camera(render::LensModel::exact);
        const auto pinhole = camera(render::LensModel::pinhole_profile);
        const auto thin = camera(render::LensModel::thin_lens_profile);
        double axis = 0.0;
        double worst = 0.0;
        for (const std::uint32_t column : {20U, 24U, 28U, 32U, 36U, 40U}) {
            constexpr std::uint32_t kSamples = 1U << 14U;
            const Seen of_exact = irradiance(*exact, column, kSamples);
            const Seen of_pinhole = irradiance(*pinhole, column, kSamples);
            const Seen of_thin = irradiance(*thin, column, kSamples);
            axis = column == 20U ? of_exact.irradiance : axis;
            const double off = std::abs(of_pinhole.irradiance - of_exact.irradiance);
            worst = std::max(worst, off / axis);
            EXPECT_LT(off, 4.0 * std::hypot(of_exact.error, of_pinhole.error) + 1e-3 * axis) << name << column;
            EXPECT_NEAR(of_thin.irradiance, of_pinhole.irradiance, 1e-12 * axis) << name << column;
        }
        fmt::print("{}: irradiance within {:.2g} of the axis's\n", name, worst);
        EXPECT_LT(worst, 4e-3) << name;
    }
}

// The corner of the 220° fisheye's image looks behind the camera, and light from there lands in it.
TEST(ProfileCamera, LooksBehindThroughAFisheye) {
    const optics::Lens lens = lens_at("fisheye-220", 8.0, 1e6);
    const render::ProfileCamera camera = camera_of(lens, 11.5, false, 1e6);
    const spectral::PathWavelengths path{{8, 8, 8, 8}};
    for (const double field_deg : {89.0, 90.0, 91.0, 105.0}) {
        const double field = radians(field_deg);
        const auto chief = optics::ChiefRays(lens, kWavelengths[8]).at_field(field).value();
        const Vec3d travels{0.0, std::sin(field), std::cos(field)};
        int landed = 0;
        for (int i = 0; i < 64; ++i) {
            const auto in = camera.sample({travels, true}, path, (i + 0.5) / 64.0, std::fmod(0.618 * i, 1.0));
            ASSERT_TRUE(in.has_value());
            const render::FilmImportance film = camera.importance(kOnAxis, in->ray, path);
            if (film.transmittance[0] > 0.0) {
                ++landed;
                EXPECT_NEAR(length(film_of(film, 0) - Vec2d{0.0, chief.image_height}), 0.0, 1e-3) << field_deg;
            }
        }
        EXPECT_GT(landed, 8) << field_deg;
    }
}

TEST(LensProfile, RefusesLensesThatHaveNone) {
    optics::Lens lens = lens_at("tessar", 4.0, 1e6);
    lens.is_rotationally_symmetric = false;
    EXPECT_TRUE(says(complaint_about([&] { render::traced_profile(lens, kWavelengths, 20.0); }),
                     "is not rotationally symmetric"));
}

}  // namespace lensproof::profile_camera_test
