// Camera paths that a device fills against those of this machine's packets: the same bits in the same order.
#include "engine/render/camera/device_paths.h"

#include <fmt/format.h>

#include "tests/engine/every_device.h"
#include "tests/engine/render/camera/some_paths.h"

namespace lensproof::render::device_paths_test {

using namespace camera_test;

constexpr CameraPathRange kTile{
    .first_pixel = 9, .pixels = 6, .first_sample = 3, .samples = 61, .rows = 5, .beside_row = 2};

template <class T>
optics::SpectralLens<T> in(const optics::SpectralLens<double>& lens) {
    std::vector<optics::TraceLens<T>> at;
    for (const optics::TraceLens<double>& wide : lens.at()) {
        at.push_back(optics::convert_lens<T>(wide));
    }
    return optics::SpectralLens<T>(std::move(at));
}

/// What was told of a device that fails.
struct Told {
    int times = 0;
    std::string why;
};

template <class T>
Paths on_device(const device::Device& device, const TestCamera& camera, const optics::SpectralLens<T>& lens,
                const CameraPathRange& range, int capacity, Told* told = nullptr) {
    device::SharedDevice fills(device, {}, [&](const std::string& why) {
        ASSERT_NE(told, nullptr) << why;
        ++told->times;
        told->why = why;
    });
    const DeviceCamera<T> there(device, lens, camera.slices);
    return all_paths(DevicePaths<T>(fills, there, camera.film, camera.pupil.plane_z(), true,
                                    BasicLensPaths<T>(camera.film, lens, camera.slices)),
                     range, capacity);
}

/// With the expected weights where they differ by the rounding of exponentials where waves fade in coatings, which are
/// a GPU's own: of 2 ulp at most (CUDA C++ Programming Guide, "Mathematical Functions"), some four at each face, of
/// which the lens has fewer than ten.
template <class T>
Paths but_for_coatings(Paths found, const Paths& expected) {
    for (std::size_t i = 0; i < std::min(found.valid.size(), expected.valid.size()); ++i) {
        const double weight = expected.valid[i].weight;
        if (std::abs(found.valid[i].weight - weight) <= 100.0 * std::numeric_limits<T>::epsilon() * weight) {
            found.valid[i].weight = weight;
        }
    }
    return found;
}

template <class T>
void compare(const TestCamera& camera, const CameraPathRange& range, const std::string& name, bool is_coated) {
    const optics::SpectralLens<T> lens = in<T>(camera.lens);
    const Paths expected = all_paths(BasicLensPaths<T>(camera.film, lens, camera.slices), range, 4096);
    EXPECT_GT(expected.valid.size(), 100U) << name;
    for (const device::Device& device : every_device()) {
        for (const int capacity : {1, 5, 16, 100, 4096}) {
            Paths found = on_device(device, camera, lens, range, capacity);
            if (is_coated && device.is_gpu()) {
                found = but_for_coatings<T>(std::move(found), expected);
            }
            expect_same(found, expected, fmt::format("{}, {}, capacity {}", name, device.name(), capacity));
        }
    }
}

TEST(DevicePaths, HaveTheBitsOfPacketsInOrder) {
    for (const auto& [name, half_diagonal_mm] :
         {std::pair{"tessar", 70.0}, {"muller-fisheye", 16.0}, {"heliar-tronnier", 25.0}}) {
        const TestCamera camera(name, half_diagonal_mm);
        const bool is_coated = name == std::string("heliar-tronnier");
        compare<double>(camera, kTile, name, is_coated);
        compare<float>(camera, kTile, name, is_coated);
    }
}

TEST(DevicePaths, BringNoFilmPointsWhereNobodyAsks) {
    const TestCamera camera("tessar", 70.0);
    const Paths expected = all_paths(BasicLensPaths<double>(camera.film, camera.lens, camera.slices), kTile, 4096);
    for (const device::Device& device : every_device()) {
        device::SharedDevice fills(device, {}, {});
        const DeviceCamera<double> there(device, camera.lens, camera.slices);
        Paths found = all_paths(DevicePaths<double>(fills, there, camera.film, camera.pupil.plane_z(), false,
                                                    BasicLensPaths<double>(camera.film, camera.lens, camera.slices)),
                                kTile, 4096);
        ASSERT_EQ(found.valid.size(), expected.valid.size()) << device.name();
        for (std::size_t i = 0; i < found.valid.size(); ++i) {
            EXPECT_EQ(found.valid[i].etendue, 0.0) << "a new buffer's";
            found.valid[i].film = expected.valid[i].film;
            found.valid[i].etendue = expected.valid[i].etendue;
        }
        expect_same(found, expected, device.name());
    }
}

// More samples than a device fills at a time, the last of them in a short piece.
TEST(DevicePaths, GoOnFromPieceToPiece) {
    const TestCamera camera("tessar", 40.0);
    const CameraPathRange many{.pixels = 48, .samples = 2100};
    const optics::SpectralLens<float> lens = in<float>(camera.lens);
    const Paths expected = all_paths(BasicLensPaths<float>(camera.film, lens, camera.slices), many, 4096);
    for (const device::Device& device : every_device()) {
        expect_same(on_device(device, camera, lens, many, 4096), expected, device.name());
    }
}

TEST(DevicePaths, OfNoSamplesOrPixelsAreNone) {
    const TestCamera camera("tessar", 70.0);
    const optics::SpectralLens<double> lens = in<double>(camera.lens);
    for (const device::Device& device : every_device()) {
        EXPECT_TRUE(on_device(device, camera, lens, {.pixels = 48, .samples = 0}, 64).valid.empty());
        EXPECT_TRUE(on_device(device, camera, lens, {.pixels = 0, .samples = 16}, 64).valid.empty());
    }
}

TEST(DevicePaths, BeginAnewWithARange) {
    const TestCamera camera("tessar", 70.0);
    for (const device::Device& device : every_device()) {
        device::SharedDevice fills(device, {}, [](const std::string& why) { FAIL() << why; });
        const DeviceCamera<double> there(device, camera.lens, camera.slices);
        DevicePaths<double> paths(fills, there, camera.film, camera.pupil.plane_z(), true,
                                  LensPaths(camera.film, camera.lens, camera.slices));
        CameraPathBuffer buffer(20);
        paths.start({.first_pixel = 20, .pixels = 8, .samples = 50});
        EXPECT_TRUE(paths.fill(buffer));
        paths.start({.first_pixel = 27, .pixels = 1, .samples = 1});
        EXPECT_TRUE(paths.fill(buffer));
        EXPECT_EQ(buffer.size, 1);
        EXPECT_EQ(buffer.pixel[0], 27U);
        EXPECT_FALSE(paths.fill(buffer));
    }
}

// As threads have them: each goes through a range of its own.
TEST(DevicePaths, CopiesGoTheirOwnWay) {
    const TestCamera camera("tessar", 70.0);
    const CameraPathRange other{.first_pixel = 30, .pixels = 10, .samples = 40};
    const auto on_processors = [&](const CameraPathRange& range) {
        return all_paths(LensPaths(camera.film, camera.lens, camera.slices), range, 64);
    };
    for (const device::Device& device : every_device()) {
        device::SharedDevice fills(device, {}, [](const std::string& why) { FAIL() << why; });
        const DeviceCamera<double> there(device, camera.lens, camera.slices);
        DevicePaths<double> paths(fills, there, camera.film, camera.pupil.plane_z(), true,
                                  LensPaths(camera.film, camera.lens, camera.slices));
        paths.start(kTile);
        expect_same(all_paths(DevicePaths<double>(paths), other, 64), on_processors(other), "a copy");
        DevicePaths<double> copy = paths;
        copy.start(other);
        expect_same(all_paths(paths, kTile, 64), on_processors(kTile), "the first, begun anew");
    }
}

// Whichever call fails first: no path is lost, none comes twice, and it is told once.
TEST(DevicePaths, LoseNothingWhereADeviceFails) {
    const TestCamera camera("tessar", 40.0);
    const CameraPathRange many{.pixels = 48, .samples = 2100};
    const optics::SpectralLens<float> lens = in<float>(camera.lens);
    const Paths expected = all_paths(BasicLensPaths<float>(camera.film, lens, camera.slices), many, 4096);
    int failures = 0;
    for (int calls = 0;; ++calls) {
        ASSERT_LT(calls, 200);
        Told told;
        try {
            expect_same(on_device(device::Device::stand_in(calls), camera, lens, many, 1000, &told), expected,
                        fmt::format("after {} calls", calls));
        } catch (const device::Error&) {
            continue;  // before the paths: the lens did not get there
        }
        if (told.times == 0) {
            break;  // no call was left to fail
        }
        EXPECT_EQ(told.times, 1);
        EXPECT_NE(told.why.find("stand-in"), std::string::npos) << told.why;
        ++failures;
    }
    EXPECT_GT(failures, 12);
}

}  // namespace lensproof::render::device_paths_test
