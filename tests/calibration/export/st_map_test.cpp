// ST-maps, read back by OpenImageIO and used as compositing programs use them.
#include "calibration/export/st_map.h"

#include <OpenImageIO/imagebuf.h>
#include <gtest/gtest.h>

#include "engine/base/input_error.h"
#include "tests/calibration/export/export_profile.h"
#include "tests/test_folder.h"

namespace lensproof::calibration::st_map_test {

using namespace synthetic;

// Written, and read by the library that compositing programs read EXR with. Coordinates are the frame's.
class ReadMap {
  public:
    ReadMap(const StMap& map, const TestFolder& folder) {
        const auto file = folder.path() / (map.image.metadata.at("lensproof:map") + ".exr");
        formats::write_exr(map.image, file, map.placement);
        buffer_.reset(file.string());
        EXPECT_TRUE(buffer_.read(0, 0, true, OIIO::TypeDesc::FLOAT));
    }
    [[nodiscard]] const OIIO::ImageSpec& spec() const { return buffer_.spec(); }
    [[nodiscard]] std::array<float, 4> at(int x, int y) const {
        std::array<float, 4> pixel{};
        buffer_.getpixel(x, y, pixel.data());
        return pixel;
    }
    // The source's pixel coordinates: from u, v with the origin at the lower left, pixel centres at +0.5.
    [[nodiscard]] Vec2d source(int x, int y) const {
        const auto pixel = at(x, y);
        return {pixel[0] * spec().full_width - 0.5, (1.0 - pixel[1]) * spec().full_height - 0.5};
    }

  private:
    OIIO::ImageBuf buffer_;
};

// A u of 2 (far overscan) in 32 bits is right to 1.2e-7, of 160 px 2e-5 px.
constexpr double kFloat_px = 5e-5;

// The camera with pixels four times as large: 160 × 120.
Profile small(const CameraModel& model) {
    std::vector<double> values = parameters(model);
    for (std::size_t i = 0; i < 3; ++i) {
        values[i] /= 4.0;
    }
    return profile_of(with_parameters(model, values), 160, 120);
}

// Undistorted pixels take their colour from where the lens images the ray of a pinhole, and photo pixels from where a
// pinhole images theirs, with the tangential terms; the overscan holds the whole photo.
TEST(ExportStMap, MapsSayWhereTheLensImages) {
    const Profile profile = small(perspective_camera());
    const StMaps maps = st_maps(profile, {});
    const TestFolder folder;
    const ReadMap undistort(maps.undistort, folder);
    EXPECT_EQ(undistort.spec().full_width, 160);
    EXPECT_EQ(undistort.spec().full_height, 120);
    EXPECT_LT(undistort.spec().x, 0);  // a barrel's corners lie outside its frame once straight
    EXPECT_LT(undistort.spec().y, 0);
    const auto& camera = std::get<BrownConrady>(profile.geometry->model).parameters;
    for (const auto& [x, y] : {std::pair{undistort.spec().x, undistort.spec().y}, {0, 0}, {80, 61}, {159, 25}}) {
        const Vec2d expected =
            *project(profile.geometry->model, {(x - camera[1]) / camera[0], (y - camera[2]) / camera[0], 1.0});
        EXPECT_NEAR(undistort.source(x, y).x, expected.x, kFloat_px);
        EXPECT_NEAR(undistort.source(x, y).y, expected.y, kFloat_px);
    }
    const ReadMap distort(maps.distort, folder);
    EXPECT_EQ(distort.spec().x, 0);
    EXPECT_EQ(distort.spec().width, 160);
    for (const auto& [x, y] : {std::pair{0, 0}, {80, 60}, {159, 119}, {25, 100}}) {
        const Vec3d direction = *unproject(profile.geometry->model, {double(x), double(y)});
        EXPECT_NEAR(distort.source(x, y).x, camera[1] + camera[0] * direction.x / direction.z, kFloat_px);
        EXPECT_NEAR(distort.source(x, y).y, camera[2] + camera[0] * direction.y / direction.z, kFloat_px);
        // That source lies within the undistorted picture, whose map leads back to the pixel.
        const Vec2d there = distort.source(x, y);
        const Vec2d back =
            undistort.source(static_cast<int>(std::lround(there.x)), static_cast<int>(std::lround(there.y)));
        EXPECT_NEAR(back.x, x, 0.6);
        EXPECT_NEAR(back.y, y, 0.6);
    }
}

// Nuke's convention, on a lens without distortion: the maps are the identity, whose u grows to the right and v upwards.
TEST(ExportStMap, WithoutDistortionTheMapIsTheIdentity) {
    const Profile profile = profile_of(BrownConrady{{500.0, 49.5, 39.5, 0, 0, 0, 0, 0}}, 100, 80);
    const StMaps maps = st_maps(profile, {});
    for (const StMap* map : {&maps.undistort, &maps.distort}) {
        const ReadMap read(*map, TestFolder());
        EXPECT_NEAR(read.at(0, 0)[0], 0.5 / 100, 1e-7);
        EXPECT_NEAR(read.at(0, 0)[1], 1.0 - 0.5 / 80, 1e-7);
        EXPECT_NEAR(read.at(99, 79)[0], 99.5 / 100, 1e-7);
        EXPECT_NEAR(read.at(99, 79)[1], 0.5 / 80, 1e-7);
        EXPECT_NE(read.spec().get_string_attribute("lensproof:convention").find("lower left"), std::string::npos);
    }
}

// B says where the model was measured: within 0.9 of 100 px of (79.6, 60.8).
TEST(ExportStMap, CoverageIsMarked) {
    const ReadMap map(st_maps(small(perspective_camera()), {}).distort, TestFolder());
    EXPECT_EQ(map.at(80, 61)[2], 1.0F);
    EXPECT_EQ(map.at(0, 0)[2], 0.0F);
    EXPECT_EQ(map.at(0, 0)[3], 1.0F);
}

// A fisheye of 105° at the corners: a pinhole cannot hold it, so what lies beyond is marked and counted, the overscan
// stops at its bound; an equidistant picture holds all of it.
TEST(ExportStMap, AFisheyeIsCutOrUndistortedToAFisheye) {
    const Profile profile = small(fisheye_camera());
    const StMaps pinhole = st_maps(profile, {.most_overscan = 0.25});
    EXPECT_EQ(pinhole.undistort.placement.x, -40);
    EXPECT_EQ(pinhole.undistort.placement.y, -30);
    EXPECT_EQ(pinhole.distort.image.at(0, 0, 3), 0.0F);
    EXPECT_EQ(pinhole.distort.image.at(0, 0, 0), -1.0F);
    const auto says_lost = [](const StMaps& maps) {
        return std::ranges::any_of(maps.notes, [](const auto& n) { return n.find("beyond the overscan") != n.npos; });
    };
    EXPECT_TRUE(says_lost(pinhole));
    const StMaps equidistant = st_maps(profile, {.undistorted = optics::Projection::equidistant});
    EXPECT_FALSE(says_lost(equidistant));
    EXPECT_EQ(equidistant.distort.image.at(0, 0, 3), 1.0F);
}

TEST(ExportStMap, ThreadsChangeNothing) {
    const Profile profile = small(perspective_camera());
    EXPECT_EQ(st_maps(profile, {.threads = 1}).undistort.image.pixels,
              st_maps(profile, {.threads = 3}).undistort.image.pixels);
}

}  // namespace lensproof::calibration::st_map_test
