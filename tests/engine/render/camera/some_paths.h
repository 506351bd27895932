// tests/engine/render/camera/some_paths.h — camera paths of a small film, to be compared one by one.
#pragma once
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "engine/formats/prescription/load_lens.h"
#include "engine/optics/convert_lens.h"
#include "engine/render/camera/lens_paths.h"

namespace lensproof::render::camera_test {

inline constexpr std::uint64_t kSeed = 17;
inline const std::vector<double> kWavelengths = {430.0, 490.0, 550.0, 610.0, 670.0};

/// A camera whose corners lie outside its image circle, so that some pixels lose a part of their paths and some all.
struct TestCamera {
    explicit TestCamera(const std::string& name, double half_diagonal_mm, bool by_radius = true)
        : lens(optics::at_wavelengths<double>(formats::load_lens(name), kWavelengths)),
          pupil(lens.at(), by_radius, half_diagonal_mm),
          slices(pupil, lens.wavelengths()),
          film{.sensor = {.width = 8, .height = 6, .pixel_pitch_mm = half_diagonal_mm / 5.0}, .seed = kSeed} {}

    optics::SpectralLens<double> lens;
    pupil::PupilMap pupil;
    pupil::PupilSlices slices;
    FilmSampling film;
};

struct Path {
    std::uint32_t pixel = 0;
    std::uint32_t sample = 0;
    int wavelength = 0;
    Vec2d film;
    double weight = 0.0;
    double etendue = 0.0;
    Ray<double> exit;
    friend bool operator==(const Path& a, const Path& b) {
        return a.pixel == b.pixel && a.sample == b.sample && a.wavelength == b.wavelength && a.film == b.film &&
               a.weight == b.weight && a.etendue == b.etendue && a.exit.origin == b.exit.origin &&
               a.exit.direction == b.exit.direction;
    }
};

struct Paths {
    std::vector<Path> valid;
    std::int64_t started = 0;
};

/// All paths of a range.
template <class Filled>
Paths all_paths(Filled&& paths, const CameraPathRange& range, int capacity) {
    CameraPathBuffer buffer(capacity);
    Paths found;
    paths.start(range);
    while (paths.fill(buffer)) {
        EXPECT_GT(buffer.size, 0);
        EXPECT_LE(buffer.size, capacity);
        for (std::size_t i = 0; i < static_cast<std::size_t>(buffer.size); ++i) {
            found.valid.push_back({buffer.pixel[i],
                                   buffer.sample[i],
                                   buffer.wavelength[i],
                                   {buffer.film_x[i], buffer.film_y[i]},
                                   buffer.weight[i],
                                   buffer.etendue[i],
                                   buffer.ray(i)});
        }
    }
    EXPECT_FALSE(paths.fill(buffer)) << "the end stays the end";
    found.started = paths.started();
    return found;
}

/// Tells which path is another rather than all.
inline void expect_same(const Paths& found, const Paths& expected, const std::string& where) {
    EXPECT_EQ(found.started, expected.started) << where;
    ASSERT_EQ(found.valid.size(), expected.valid.size()) << where;
    for (std::size_t i = 0; i < found.valid.size(); ++i) {
        ASSERT_TRUE(found.valid[i] == expected.valid[i])
            << where << ", path " << i << ": pixel " << expected.valid[i].pixel << ", sample "
            << expected.valid[i].sample;
    }
}

}  // namespace lensproof::render::camera_test
