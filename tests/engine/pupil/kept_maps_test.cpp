#include "engine/pupil/kept_maps.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "engine/base/file.h"
#include "engine/base/infinity.h"
#include "engine/formats/prescription/load_lens.h"
#include "engine/optics/lens.h"
#include "engine/spectral/wavelengths.h"
#include "tests/engine/every_device.h"
#include "tests/test_folder.h"

namespace lensproof::pupil::kept_maps_test {

std::vector<optics::TraceLens<double>> tessar() {
    return {optics::at_wavelength<double>(formats::load_lens("tessar"), spectral::kLineD)};
}

/// The folder's only file.
std::filesystem::path only_file(const TestFolder& folder) {
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(folder.path())) {
        files.push_back(entry.path());
    }
    EXPECT_EQ(files.size(), 1U);
    return files.at(0);
}

// To the last bit the map that is made, without a cache, with an empty one and with a full one; and the full one is
// read, not made again: a whole file with another map in it is what comes back.
TEST(KeptMaps, AreTheMapsThatAreMade) {
    const TestFolder folder;
    const Cache cache(folder.path());
    const PupilMap made(tessar(), true, 30.0);
    EXPECT_EQ(kept_pupil_map({}, tessar(), true, 30.0).serialized(), made.serialized());
    EXPECT_EQ(kept_pupil_map(cache, tessar(), true, 30.0).serialized(), made.serialized());
    EXPECT_EQ(kept_pupil_map(cache, tessar(), true, 30.0).serialized(), made.serialized());
    const PupilMap kept = PupilMap::deserialized(made.serialized()).value();
    for (int i = 0; i < 100; ++i) {
        const Vec2d at{0.2 * i, 0.1 * i};
        const PupilSample a = made.sample(at, 0.0, 0.01 * i + 0.005, 0.3);
        const PupilSample b = kept.sample(at, 0.0, 0.01 * i + 0.005, 0.3);
        EXPECT_EQ(a.point, b.point);
        EXPECT_EQ(a.pdf, b.pdf);
    }

    const std::string whole = read_file(only_file(folder));
    const std::string map = made.serialized();
    const std::size_t at = whole.find(map);
    ASSERT_NE(at, std::string::npos);
    const std::string key = whole.substr(whole.find("pupil") + 5 + 8, at - (whole.find("pupil") + 5 + 8));
    const std::string other = PupilMap::whole_element(tessar()[0], 30.0).serialized();
    cache.store("pupil", key, other);
    EXPECT_EQ(kept_pupil_map(cache, tessar(), true, 30.0).serialized(), other) << "read from the cache";
    for (const std::string& damaged : {std::string(), std::string("no map"), map.substr(1), map.substr(0, 800)}) {
        cache.store("pupil", key, damaged);
        EXPECT_EQ(kept_pupil_map(cache, tessar(), true, 30.0).serialized(), map) << "made again";
    }
}

// Whatever a map follows from makes it another one.
TEST(KeptMaps, AreKeptApart) {
    const TestFolder folder;
    const Cache cache(folder.path());
    const auto files = [&] {
        return std::distance(std::filesystem::directory_iterator(folder.path()), std::filesystem::directory_iterator());
    };
    std::vector<optics::TraceLens<double>> lens = tessar();
    kept_pupil_map(cache, lens, true, 20.0);
    kept_pupil_map(cache, lens, true, 20.5);
    kept_pupil_map(cache, lens, true, 20.0, {.defensive_fraction = 0.01});
    kept_pupil_map(cache, lens, true, 20.0, {.most_excess = 0.1});
    kept_pupil_map(cache, {lens[0], lens[0]}, true, 20.0);
    kept_entrance_map(cache, lens, true);
    kept_entrance_map(cache, lens, true, 1000.0);
    EXPECT_EQ(files(), 7);
    lens[0].image_z += 1e-12;
    kept_pupil_map(cache, lens, true, 20.0);
    EXPECT_EQ(files(), 8);
    // Of the same stop with blades the map is the same.
    lens[0].surfaces[0].special = 0;
    lens[0].specials.emplace_back();
    kept_pupil_map(cache, lens, true, 20.0);
    EXPECT_EQ(files(), 9);
    lens[0].specials[0].mask = optics::StopMask(optics::PolygonStop{.blades = 5});
    kept_pupil_map(cache, lens, true, 20.0);
    EXPECT_EQ(files(), 9);
}

// A device that traces for a map: to the last bit the map that is made without, and the device has traced.
TEST(KeptMaps, AreMadeTheSameOnADevice) {
    const std::string pupil = PupilMap(tessar(), true, 30.0).serialized();
    const std::string entrance = EntranceMap(tessar(), true).serialized();
    for (const device::Device& device : every_device()) {
        const auto fail = [](const std::string& why) { ADD_FAILURE() << why; };
        device::SharedDevice shared(device, fail, fail);
        EXPECT_EQ(PupilMap(tessar(), true, 30.0, {.device = &shared}).serialized(), pupil) << device.name();
        EXPECT_EQ(EntranceMap(tessar(), true, kInfinity, {.device = &shared}).serialized(), entrance) << device.name();
    }
    bool has_failed = false;
    const auto heard = [&](const std::string&) { has_failed = true; };
    const device::Device failing = device::Device::stand_in(0);
    device::SharedDevice shared(failing, heard, heard);
    EXPECT_EQ(PupilMap(tessar(), true, 30.0, {.device = &shared}).serialized(), pupil);
    EXPECT_TRUE(has_failed);
}

TEST(KeptMaps, EntrancesComeBackToo) {
    for (const double distance_mm : {kInfinity, 500.0}) {
        const EntranceMap made(tessar(), true, distance_mm);
        const std::string bytes = made.serialized();
        EXPECT_EQ(EntranceMap::deserialized(bytes).value().serialized(), bytes);
        for (std::size_t length = 0; length < bytes.size(); length += length < 200 ? 1 : 97) {
            EXPECT_FALSE(EntranceMap::deserialized(std::string_view(bytes).substr(0, length))) << length;
        }
    }
}

}  // namespace lensproof::pupil::kept_maps_test
