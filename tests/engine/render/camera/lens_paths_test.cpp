#include "engine/render/camera/lens_paths.h"

#include <fmt/format.h>

#include <cmath>

#include "engine/render/sampling/sampler.h"
#include "tests/engine/render/camera/some_paths.h"

namespace lensproof::render::lens_paths_test {

using namespace camera_test;

/// What passes the lens of a range of samples, worked out path by path.
Paths one_by_one(const TestCamera& camera, const CameraPathRange& range) {
    const Sensor& sensor = camera.film.sensor;
    const double film_z = camera.lens.at(0).image_z;
    Paths found;
    for (std::uint32_t i = 0; i < range.pixels * range.rows; ++i) {
        const std::uint32_t pixel = range.first_pixel + i + i / range.pixels * range.beside_row;
        const PixelSampler sampler(kSeed, pixel);
        const std::uint32_t row = pixel / 8;
        for (std::uint32_t sample = range.first_sample; sample < range.first_sample + range.samples; ++sample) {
            const auto xi = sampler.point(sample);
            const int wavelength = static_cast<int>(xi[4] * static_cast<double>(kWavelengths.size()));
            const Vec2d film = sensor.position(pixel % 8 - 0.5 + xi[0], row - 0.5 + xi[1]);
            const pupil::PupilDraw<double> in_pupil = camera.slices.sample(film, wavelength, xi[2], xi[3]);
            if (!(in_pupil.area > 0.0)) {
                continue;
            }
            ++found.started;
            const Vec3d to_pupil{in_pupil.point.x - film.x, in_pupil.point.y - film.y, camera.pupil.plane_z() - film_z};
            const double per_distance2 = 1.0 / dot(to_pupil, to_pupil);
            const Vec3d direction = std::sqrt(per_distance2) * to_pupil;
            const optics::TracedRay<double> traced = optics::trace<optics::Direction::reverse>(
                camera.lens.at(wavelength), {{film.x, film.y, film_z}, direction});
            if (traced.status == optics::RayStatus::ok) {
                const double etendue = direction.z * direction.z * per_distance2 * in_pupil.area;
                found.valid.push_back(
                    {pixel, sample, wavelength, film, traced.transmittance * etendue, etendue, traced.ray});
            }
        }
    }
    return found;
}

Paths through_buffers(const TestCamera& camera, const CameraPathRange& range, int capacity, SimdLevel level) {
    return all_paths(LensPaths(camera.film, camera.lens, camera.slices, level), range, capacity);
}

// Every path has the bits of the plain manner of making it, and its place in the order, whatever the packets' width and
// the buffer's capacity, smaller than a pixel's samples or larger; those that the lens stops are left out and nothing
// else.
TEST(LensPaths, HaveTheBitsOfOneByOneInOrder) {
    for (const auto& [name, half_diagonal_mm] : {std::pair{"tessar", 70.0}, {"muller-fisheye", 16.0}}) {
        const TestCamera camera(name, half_diagonal_mm);
        const CameraPathRange all{.first_pixel = 0, .pixels = 48, .first_sample = 0, .samples = 37};
        const Paths expected = one_by_one(camera, all);
        EXPECT_LT(expected.started, 48 * 37) << "some of the film gets no light";
        EXPECT_LT(expected.valid.size(), static_cast<std::size_t>(expected.started)) << "the lens stops some paths";
        EXPECT_GT(expected.valid.size(), 48U * 37U / 3U) << "and passes many";
        for (const SimdLevel level : available_simd_levels()) {
            for (const int capacity : {1, 5, 16, 100, 4096}) {
                expect_same(through_buffers(camera, all, capacity, level), expected,
                            fmt::format("{}, {}, capacity {}", name, simd_name(level), capacity));
            }
        }
    }
}

// A path does not depend on the range that it was asked for in.
TEST(LensPaths, DoNotDependOnTheRange) {
    const TestCamera camera("tessar", 70.0);
    const CameraPathRange part{.first_pixel = 19, .pixels = 5, .first_sample = 250, .samples = 12};
    expect_same(through_buffers(camera, part, 64, available_simd_levels().back()), one_by_one(camera, part), "part");
}

// As tiles are, of which rows are a part of the film's.
TEST(LensPaths, OfARectangleGoRowByRow) {
    const TestCamera camera("tessar", 70.0);
    const CameraPathRange tile{
        .first_pixel = 10, .pixels = 3, .first_sample = 7, .samples = 21, .rows = 4, .beside_row = 5};
    const Paths expected = one_by_one(camera, tile);
    for (const SimdLevel level : available_simd_levels()) {
        for (const int capacity : {1, 16, 50, 4096}) {
            expect_same(through_buffers(camera, tile, capacity, level), expected, "tile");
        }
    }
}

// A lens that is not known to be round has no tables of pupils for packets.
TEST(LensPaths, HaveTheSameBitsWherePupilsAreDrawnOneByOne) {
    const TestCamera camera("tessar", 30.0, false);
    const CameraPathRange part{.first_pixel = 0, .pixels = 48, .first_sample = 0, .samples = 3};
    ASSERT_EQ(camera.slices.tables(), nullptr);
    expect_same(through_buffers(camera, part, 64, available_simd_levels().back()), one_by_one(camera, part), "turned");
}

// The top left pixel lies outside the fisheye's image circle: the few paths that the map starts there in defence all
// end in the lens.
TEST(LensPaths, MayAllBeStopped) {
    const TestCamera camera("muller-fisheye", 40.0);
    const CameraPathRange corner{.pixels = 1, .samples = 4000};
    const Paths paths = through_buffers(camera, corner, 64, available_simd_levels().back());
    EXPECT_TRUE(paths.valid.empty());
    EXPECT_GT(paths.started, 0);
}

TEST(LensPaths, OfNoSamplesOrPixelsAreNone) {
    const TestCamera camera("tessar", 70.0);
    const SimdLevel level = available_simd_levels().back();
    EXPECT_TRUE(through_buffers(camera, {.pixels = 48, .samples = 0}, 64, level).valid.empty());
    EXPECT_TRUE(through_buffers(camera, {.pixels = 0, .samples = 16}, 64, level).valid.empty());
}

TEST(LensPaths, BeginAnewWithARange) {
    const TestCamera camera("tessar", 70.0);
    LensPaths paths(camera.film, camera.lens, camera.slices);
    CameraPathBuffer buffer(20);
    paths.start({.first_pixel = 20, .pixels = 8, .samples = 50});
    EXPECT_TRUE(paths.fill(buffer));
    paths.start({.first_pixel = 27, .pixels = 1, .samples = 1});
    EXPECT_TRUE(paths.fill(buffer));
    EXPECT_EQ(buffer.size, 1);
    EXPECT_EQ(buffer.pixel[0], 27U);
    EXPECT_FALSE(paths.fill(buffer));
}

TEST(CameraPathBuffer, HasRoomForOnePathAtLeast) {
    EXPECT_THROW(CameraPathBuffer(0), std::invalid_argument);
}

}  // namespace lensproof::render::lens_paths_test
