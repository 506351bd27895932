// Paths out of cameras with a lens's profile, in packets.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "engine/formats/prescription/load_lens.h"
#include "engine/render/camera/profile_camera.h"

namespace lensproof::render::profile_paths_test {

const spectral::SpectralGrid kGrid = spectral::spectral_grid(420.0, 680.0, 8);
constexpr Sensor kSensor{.width = 40, .height = 30, .pixel_pitch_mm = 1.4};

/// All that paths say.
struct Told {
    std::vector<double> numbers;  // film point, weight, ray; pdfs
    std::vector<float> weights;
    friend bool operator==(const Told&, const Told&) = default;
};

/// `use(paths)` with each buffer of samples from all over the film.
template <class Use>
void for_each_buffer(const ProfileCamera& camera, const PixelFilter& filter, int capacity, SimdLevel level,
                     const Use& use) {
    ProfileCamera::Paths producer(camera, {.sensor = kSensor, .seed = 3, .filter = filter}, kGrid,
                                  PathCarry::wavelengths_and_pdfs, level);
    CameraPathBuffer paths(capacity);
    producer.start({.first_pixel = 0, .pixels = 1200, .first_sample = 0, .samples = 3});
    while (producer.fill(paths)) {
        use(paths);
    }
}

Told told_by(const ProfileCamera& camera, const PixelFilter& filter, int capacity, SimdLevel level) {
    Told told;
    for_each_buffer(camera, filter, capacity, level, [&](const CameraPathBuffer& paths) {
        for (std::size_t i = 0; i < static_cast<std::size_t>(paths.size); ++i) {
            const Ray<double> ray = paths.ray(i);
            told.numbers.insert(told.numbers.end(), {paths.film_x[i], paths.film_y[i], paths.weight[i], ray.origin.x,
                                                     ray.origin.y, ray.origin.z, ray.direction.x, ray.direction.y,
                                                     ray.direction.z, paths.pdf[i].shared, paths.pdf[i].hero});
            told.weights.insert(told.weights.end(), paths.weights[i].begin(), paths.weights[i].end());
        }
    });
    return told;
}

ProfileCamera camera_of(const std::string& lens, bool is_pinhole) {
    return {traced_profile(formats::load_lens(lens), kGrid.strata.midpoints(), kSensor.half_diagonal_mm()),
            {.is_pinhole = is_pinhole, .focus_z = -3000.0}};
}

// Each path has its bits at any width, among any neighbours; dark samples lie between them, since the corners are
// beyond the fisheye's image circle. Filters with negative lobes keep all their samples.
TEST(ProfilePaths, HaveTheSameBitsAtEveryWidthAndCapacity) {
    for (const char* lens : {"tessar", "muller-fisheye"}) {
        for (const bool is_pinhole : {false, true}) {
            const ProfileCamera camera = camera_of(lens, is_pinhole);
            for (const PixelFilter& filter : {PixelFilter{}, PixelFilter::named("mitchell")}) {
                const Told expected = told_by(camera, filter, 4096, SimdLevel::scalar);
                EXPECT_GT(expected.weights.size(), 1000U) << lens;
                for (const SimdLevel level : available_simd_levels()) {
                    for (const int capacity : {1, 5, 100, 4096}) {
                        EXPECT_TRUE(told_by(camera, filter, capacity, level) == expected)
                            << fmt::format("{}, {}, capacity {}", lens, simd_name(level), capacity);
                    }
                }
            }
        }
    }
}

/// What paths count is what their rays do that are met one by one (`importance`): both find the pupil's point to some
/// roundings of the ray, 1e-16 of a lens's length, and pdfs to some dozen; weights to a float's digits. Returns of how
/// many paths other wavelengths take part.
int expect_each_ray_alone(const ProfileCamera& camera, const std::string& name) {
    int shared = 0;
    for_each_buffer(camera, {}, 4096, available_simd_levels().back(), [&](const CameraPathBuffer& paths) {
        for (std::size_t i = 0; i < static_cast<std::size_t>(paths.size); ++i) {
            const Ray<double> out = paths.ray(i);
            PathPdf drawn;
            const auto expected = shared_weights(
                camera.importance(kSensor, {out.origin, -1.0 * out.direction}, kGrid.path(paths.wavelength[i])),
                path_pixel(paths, i, kSensor, true), drawn);
            EXPECT_NEAR(paths.pdf[i].hero, drawn.hero, 1e-9 * drawn.hero) << name;
            EXPECT_NEAR(paths.pdf[i].shared, drawn.shared, 1e-9 * drawn.shared) << name;
            for (std::size_t m = 0; m < expected.size(); ++m) {
                EXPECT_NEAR(paths.weights[i][m], expected[m], 1.2e-7F * expected[m]) << name;
                shared += m > 0 && expected[m] > 0.0F ? 1 : 0;
            }
        }
    });
    return shared;
}

TEST(ProfilePaths, CountWhatEachRayByItselfDoes) {
    for (const char* lens : {"tessar", "muller-fisheye"}) {
        for (const bool is_pinhole : {false, true}) {
            EXPECT_GT(expect_each_ray_alone(camera_of(lens, is_pinhole), lens), 1000) << lens;
        }
    }
}

// A field angle that hardly grows at its nodes has an inverse that a step of Newton's does not find, and radii are
// searched one by one.
TEST(ProfilePaths, FindRadiiOfStairsToo) {
    const RadialCurve stairs(40.0, {{0.0, 0.001}, {0.2, 0.0005}, {0.4, 0.0005}, {0.6, 0.0005}});
    const RisingCurve angle(stairs);
    EXPECT_FALSE(angle.is_found_in_a_step());
    EXPECT_TRUE(RisingCurve(RadialCurve(40.0, {{0.0, 0.015}, {0.3, 0.015}, {0.6, 0.015}})).is_found_in_a_step());
    const RadialCurve even(40.0, {{0.05, 0.0}, {0.05, 0.0}});
    LensProfile profile{.at = {8, RadialProfile{.field_angle = angle, .illumination = even}},
                        .pupil_z = RadialCurve(0.6, {{20.0, 0.0}, {20.0, 0.0}})};
    const ProfileCamera camera(profile, {.is_pinhole = true});
    EXPECT_GT(expect_each_ray_alone(camera, "stairs"), 1000);
}

}  // namespace lensproof::render::profile_paths_test
