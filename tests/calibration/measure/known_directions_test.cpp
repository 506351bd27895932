#include "calibration/measure/known_directions.h"

#include <gtest/gtest.h>

#include "engine/base/write_file.h"
#include "tests/complaint.h"
#include "tests/test_folder.h"

namespace lensproof::calibration::known_directions_test {

class KnownDirectionsTable : public testing::Test {
  protected:
    KnownDirections read(const std::string& text, const std::vector<std::string>& pictures = {"night.png"}) {
        write_file(folder_.path() / "stars.csv", text);
        return read_known_directions(folder_.path() / "stars.csv", pictures);
    }
    std::string refused(const std::string& text, const std::vector<std::string>& pictures = {"night.png"}) {
        return complaint_about([&] { read(text, pictures); });
    }

  private:
    TestFolder folder_;
};

void expect_near(const Vec3d& a, const Vec3d& b) {
    EXPECT_LT(length(a - b), 1e-15) << a.x << ", " << a.y << ", " << a.z;
}

TEST_F(KnownDirectionsTable, DirectionsAreThoseOfTheSkyOrOfACompass) {
    const auto sky = read("name,x_px,y_px,right_ascension_deg,declination_deg\nPole,1,2,77,90\nEast,3,4,90,0\n");
    ASSERT_EQ(sky.at("night.png").size(), 2U);
    expect_near(sky.at("night.png")[0].direction, {0, 0, 1});
    expect_near(sky.at("night.png")[1].direction, {0, 1, 0});
    EXPECT_EQ(sky.at("night.png")[1].near_px.value().y, 4.0);
    // x to the north, z up: east is on the right of who looks north, which is −y.
    const auto land = read("x_px,y_px,azimuth_deg,altitude_deg\n1,2,0,0\n3,4,90,0\n5,6,10,90\n").at("night.png");
    expect_near(land[0].direction, {1, 0, 0});
    expect_near(land[1].direction, {0, -1, 0});
    expect_near(land[2].direction, {0, 0, 1});
    const auto any = read("x_px,y_px,dx,dy,dz\n1,2,0,3,4\n").at("night.png");
    expect_near(any[0].direction, {0, 0.6, 0.8});
}

TEST_F(KnownDirectionsTable, APictureHasItsOwn) {
    const auto all = read("picture,x_px,y_px,dx,dy,dz\na.png,1,2,0,0,1\nb.png,1,2,0,1,0\na.png,3,2,0,1,1\n",
                          {"a.png", "b.png", "c.png"});
    EXPECT_EQ(all.at("a.png").size(), 2U);
    EXPECT_EQ(all.at("b.png").size(), 1U);
    EXPECT_EQ(all.count("c.png"), 0U);
}

// What has no place may be anywhere in any of them.
TEST_F(KnownDirectionsTable, OrIsOfACatalogue) {
    const auto all = read("picture,x_px,y_px,dx,dy,dz\na.png,1,2,0,0,1\n,,,0,1,0\nb.png,,,1,0,0\n", {"a.png", "b.png"});
    EXPECT_EQ(all.at("a.png").size(), 2U);
    EXPECT_EQ(all.at("b.png").size(), 2U);
    EXPECT_FALSE(all.at("a.png")[1].near_px);
    EXPECT_TRUE(says(refused("x_px,y_px,dx,dy,dz\n1,,0,1,0\n"), "stars.csv:2: y_px is \"\", expected a number beside"));
}

TEST_F(KnownDirectionsTable, IsRefusedByFileLineAndColumn) {
    EXPECT_TRUE(says(refused("x_px,y_px\n1,2\n"), "stars.csv:1: the header is \"x_px,y_px\", expected"));
    EXPECT_TRUE(says(refused("x_px,y_px,dx,dy,dz\n1,2,0,0,0\n"), "stars.csv:2: dx is \"0\", expected a direction"));
    EXPECT_TRUE(says(refused("x_px,y_px,dx,dy,dz\n1,nan,0,0,1\n"), "stars.csv:2: y_px is \"nan\""));
    EXPECT_TRUE(says(refused("x_px,y_px,azimuth_deg,altitude_deg\n1,2,0,91\n"), "stars.csv:2: altitude_deg is \"91\""));
    EXPECT_TRUE(says(refused("x_px,y_px,dx,dy,dz,magnitude\n1,2,0,0,1,3\n"), "magnitude"));
    EXPECT_TRUE(says(refused("x_px,y_px,dx,dy,dz\n1,2,0,0,1\n", {"a.png", "b.png"}), "no column picture"));
    std::string many = "picture,x_px,y_px,dx,dy,dz\n";
    for (std::size_t i = 0; i <= kMostDirections / 2; ++i) {
        many += ",,,0,0,1\n";
    }
    EXPECT_TRUE(says(refused(many, {"a.png", "b.png"}), "expected no more than 100000 directions in all pictures"));
    EXPECT_TRUE(says(refused("picture,x_px,y_px,dx,dy,dz\nmoon.png,1,2,0,0,1\n"),
                     "stars.csv:2: picture is \"moon.png\", expected the name of a picture that is given: night.png"));
}

}  // namespace lensproof::calibration::known_directions_test
