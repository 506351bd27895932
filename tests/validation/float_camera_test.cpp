// The exact camera in float against itself in double.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "engine/base/infinity.h"
#include "engine/optics/float_error.h"
#include "engine/render/camera/camera.h"

namespace lensproof::float_camera_test {

struct Setting {
    const char* lens;
    double f_number;
    double half_diagonal_mm;
};
constexpr std::array<Setting, 4> kCameras{{{"double-gauss-tronnier", 2.0, 21.6},
                                           {"tessar", 2.8, 45.0},
                                           {"muller-fisheye", 8.0, 12.75},
                                           {"canon-zoom-70-200", 2.8, 21.6}}};

std::unique_ptr<render::Camera> camera_of(const char* lens, double f_number, double half_diagonal_mm,
                                          render::LensModel model) {
    return std::make_unique<render::Camera>(
        render::CameraSettings{.lens = lens,
                               .f_number = f_number,
                               .focus_distance_mm = 3000.0,
                               .sensor = {.width = 40, .height = 30, .pixel_pitch_mm = half_diagonal_mm / 25.0},
                               .response = "luminance",
                               .model = model},
        render::SpectralSampling{400.0, 700.0, 16, 1}, render::PixelFilter{}, Cache{});
}

struct Path {
    Ray<double> ray;
    Vec2d film;
    std::uint16_t wavelength = 0;
    double weight = 0.0;
};

/// By pixel and sample.
using Paths = std::map<std::pair<std::uint32_t, std::uint32_t>, Path>;

Paths paths_of(const render::Camera& camera) {
    render::CameraPaths paths = camera.paths(2, render::PathCarry::hero);
    render::CameraPathBuffer buffer;
    Paths found;
    paths.start({.first_pixel = 0, .pixels = 1200, .first_sample = 0, .samples = 48});
    while (paths.fill(buffer)) {
        for (std::size_t i = 0; i < static_cast<std::size_t>(buffer.size); ++i) {
            found[{buffer.pixel[i], buffer.sample[i]}] = {
                buffer.ray(i), {buffer.film_x[i], buffer.film_y[i]}, buffer.wavelength[i], buffer.weight[i]};
        }
    }
    return found;
}

/// How near to a rim the path that leaves the camera along `out` passes in double, µm.
double from_rim_um(const optics::Lens& lens, const optics::TraceLens<double>& traced, const Ray<double>& out) {
    double least = kInfinity;
    optics::trace<optics::Direction::forward, optics::Rims::follow>(
        traced, {out.origin, -1.0 * out.direction}, [&](const optics::SurfaceEvent<double>& event) {
            const double semi = lens.surfaces[static_cast<std::size_t>(event.surface)].semi_diameter;
            least = std::min(least, 1e3 * std::abs(std::hypot(event.ray.origin.x, event.ray.origin.y) - semi));
        });
    return least;
}

// The same samples leave the lens by the same rays. Places differ by no more than float is allowed to cost a lens of
// this length (optics::float_error_bound_um). Directions: each surface rounds one by two ulps at most and turns it by
// what its power, c Δn, makes of a place so far beside. Paths that one has alone pass a rim within twice that bound.
// And from outside each leads back to the film point that it came from, in float too, within the bound of places and
// what that of directions makes of the lens's length.
TEST(FloatCamera, TracesTheSamePaths) {
    for (const auto& [name, f_number, half_diagonal] : kCameras) {
        const auto in_double = camera_of(name, f_number, half_diagonal, render::LensModel::exact_double);
        const auto in_float = camera_of(name, f_number, half_diagonal, render::LensModel::exact_float);
        const Paths expected = paths_of(*in_double);
        const Paths found = paths_of(*in_float);
        const optics::Lens& lens = in_double->lens().value();
        const double bound_um = optics::float_error_bound_um(lens.image_z);
        const double ulp = std::numeric_limits<float>::epsilon();
        double direction_bound = 0.0;
        for (const optics::TraceSurface<double>& surface : in_double->exact().lens().at(0).surfaces) {
            const double power = std::abs(surface.curvature * (surface.index_after - surface.index_before));
            direction_bound += 2.0 * ulp + 1e-3 * bound_um * power;
        }
        double worst_um = 0.0;
        double worst_direction = 0.0;
        double worst_film_um = 0.0;
        double sum_off = 0.0;
        double sum = 0.0;
        int alone = 0;
        for (const auto& [key, path] : expected) {
            const auto other = found.find(key);
            sum += path.weight;
            if (other == found.end()) {
                ++alone;
                const auto& traced = in_double->exact().lens().at(path.wavelength);
                EXPECT_LT(from_rim_um(lens, traced, path.ray), 2.0 * bound_um) << name;
                continue;
            }
            const Path& float_path = other->second;
            worst_um = std::max(worst_um, 1e3 * length(float_path.ray.origin - path.ray.origin));
            worst_direction = std::max(worst_direction, length(float_path.ray.direction - path.ray.direction));
            EXPECT_NEAR(length(float_path.ray.direction), 1.0, 1e-15);
            sum_off += float_path.weight - path.weight;
            const render::FilmImportance film = in_float->importance(
                {float_path.ray.origin, -1.0 * float_path.ray.direction}, in_float->grid().path(float_path.wavelength));
            if (film.transmittance[0] > 0.0) {
                const Vec2d at = in_float->sensor().position(film.at_px[0].x, film.at_px[0].y);
                worst_film_um = std::max(worst_film_um, 1e3 * length(at - float_path.film));
            }
        }
        for (const auto& [key, path] : found) {
            alone += expected.contains(key) ? 0 : 1;
        }
        fmt::print(
            "{}: {} paths, {} alone, exit {:.3f} um (bound {:.3f}), direction {:.2g} (bound {:.2g}), film {:.3f} "
            "um, light off by {:.2g}\n",
            name, expected.size(), alone, worst_um, bound_um, worst_direction, direction_bound, worst_film_um,
            sum_off / sum);
        EXPECT_GT(expected.size(), 10000U) << name;
        EXPECT_LT(alone, 6) << name;
        EXPECT_LT(worst_um, bound_um) << name;
        EXPECT_LT(worst_direction, direction_bound) << name;
        EXPECT_LT(worst_film_um, bound_um + 1e3 * lens.image_z * direction_bound) << name;
        EXPECT_LT(std::abs(sum_off / sum), 1e-6) << name;
    }
}

/// All that a camera says of its paths, row by row of its sensor.
struct Told {
    std::vector<double> paths;     // the hero's: film point, ray, weight
    std::vector<float> weights;    // of all wavelengths
    std::vector<double> pdfs;      // where they are asked for
    std::vector<float> with_pdfs;  // weights that go with them
};

Told told_by(const render::Camera& camera) {
    Told told;
    for (const render::PathCarry carry : {render::PathCarry::wavelengths, render::PathCarry::wavelengths_and_pdfs}) {
        const bool has_pdfs = carry == render::PathCarry::wavelengths_and_pdfs;
        render::CameraPaths paths = camera.paths(2, carry);
        render::CameraPathBuffer buffer;
        paths.start({.first_pixel = 0, .pixels = 1200, .first_sample = 0, .samples = 16});
        while (paths.fill(buffer)) {
            for (std::size_t i = 0; i < static_cast<std::size_t>(buffer.size); ++i) {
                const Ray<double> ray = buffer.ray(i);
                told.paths.insert(told.paths.end(),
                                  {buffer.film_x[i], buffer.film_y[i], buffer.weight[i], ray.origin.x, ray.origin.y,
                                   ray.origin.z, ray.direction.x, ray.direction.y, ray.direction.z});
                std::vector<float>& weights = has_pdfs ? told.with_pdfs : told.weights;
                weights.insert(weights.end(), buffer.weights[i].begin(), buffer.weights[i].end());
                if (has_pdfs) {
                    told.pdfs.insert(told.pdfs.end(), {buffer.pdf[i].shared, buffer.pdf[i].hero});
                }
            }
        }
    }
    return told;
}

// The usual exact camera takes float for how much of a path's other wavelengths arrives, which changes light by less
// than a ulp of it; all else has the bits of the one in double, rays towards the camera and pdfs too. Checkpoints tell
// them apart.
TEST(FloatCamera, CountsOtherWavelengthsOfHeroesInDouble) {
    for (const auto& [name, f_number, half_diagonal] : kCameras) {
        const auto in_double = camera_of(name, f_number, half_diagonal, render::LensModel::exact_double);
        const auto usual = camera_of(name, f_number, half_diagonal, render::LensModel::exact);
        const Told expected = told_by(*in_double);
        const Told found = told_by(*usual);
        EXPECT_EQ(found.paths, expected.paths) << name;
        EXPECT_EQ(found.pdfs, expected.pdfs) << name;
        EXPECT_EQ(found.with_pdfs, expected.with_pdfs) << name;
        EXPECT_NE(found.weights, expected.weights) << name;
        EXPECT_NE(usual->hash(), in_double->hash()) << name;
        ASSERT_EQ(found.weights.size(), expected.weights.size()) << name;
        double sum = 0.0;
        double sum_off = 0.0;
        for (std::size_t i = 0; i < expected.weights.size(); ++i) {
            sum += expected.weights[i];
            sum_off += static_cast<double>(found.weights[i]) - expected.weights[i];
        }
        fmt::print("{}: light off by {:.2g}\n", name, sum_off / sum);
        EXPECT_GT(expected.weights.size(), 10000U) << name;
        EXPECT_LT(std::abs(sum_off / sum), std::numeric_limits<float>::epsilon()) << name;
    }
}

}  // namespace lensproof::float_camera_test
