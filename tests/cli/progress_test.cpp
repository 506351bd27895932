// tests/cli/progress_test.cpp — what a terminal shows while pictures are measured.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>

#include "calibration/self_test/simulated_chart.h"
#include "engine/formats/image/image.h"
#include "tests/cli/program.h"
#include "tests/complaint.h"

namespace lensproof::progress_test {

using namespace calibration;

/// Three photos of a board, each tilted another way.
void write_photos(const Workplace& place) {
    SimulatedCamera camera{.model = BrownConrady{{820.0, 319.5, 239.5, -0.1, 0, 0, 0, 0}},
                           .width_px = 640,
                           .height_px = 480,
                           .channels = {{.name = "Y"}}};
    camera.blur_px = 0.7;
    camera.read_noise = 0.004;
    const scene::Chart board{.pattern = scene::Checkerboard{10, 7, 30.0}};
    place.file("board.toml", "[chart]\nkind = \"checkerboard\"\nsquares = [10, 7]\nsquare_mm = 30.0\n");
    const Vec3d turns[] = {{0.4, 0.1, 0.0}, {-0.3, 0.35, 0.1}, {0.1, -0.4, -0.1}};
    for (int i = 0; i < 3; ++i) {
        formats::write_png_16(simulate_chart(camera, {turns[i], {0.0, 0.0, 480.0}}, board, static_cast<unsigned>(i)),
                              place.path() / ("photo" + std::to_string(i) + ".png"));
    }
}

const std::vector<std::string> kMeasure = {"measure", "photo0.png", "photo1.png", "photo2.png",
                                           "--chart", "board.toml", "-o",         "profile.json"};

// The bar stands there before a quarter is done, says the time left, goes up, and is wiped away at the end. How often
// it is drawn between is a matter of the machine's speed.
TEST(Progress, IsShownFromTheBeginningWithTheTimeLeft) {
    const Workplace place;
    write_photos(place);
    const std::optional<std::string> written = said_to_a_terminal(kMeasure, place.path());
    if (!written) {
        GTEST_SKIP() << "no terminal can be opened here";
    }
    const std::string& said = *written;
    std::vector<double> percent;
    for (std::size_t at = said.find("] "); at != std::string::npos; at = said.find("] ", at + 1)) {
        percent.push_back(std::atof(said.c_str() + at + 2));
    }
    ASSERT_FALSE(percent.empty()) << said;
    EXPECT_LT(percent.front(), 25.0);
    EXPECT_TRUE(std::ranges::is_sorted(percent)) << said;
    EXPECT_TRUE(says(said, " s left"));
    EXPECT_TRUE(said.ends_with("\r\033[K")) << said;
}

TEST(Progress, IsNotShownToThoseWhoWantNone) {
    const Workplace place;
    write_photos(place);
    std::vector<std::string> quiet = kMeasure;
    quiet.emplace_back("--quiet");
    EXPECT_EQ(said_to_a_terminal(quiet, place.path()).value_or(""), "");
    EXPECT_EQ(place.run(kMeasure).err, "") << "no terminal";
}

}  // namespace lensproof::progress_test
