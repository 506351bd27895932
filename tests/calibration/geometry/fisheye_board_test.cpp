#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "calibration/detection/detect.h"
#include "calibration/detection/refine.h"
#include "tests/places.h"

namespace lensproof::calibration::fisheye_board_test {

// Fifteen photos of a board of 6 × 8 inner corners that a fisheye bends: every one is found, nearly every corner
// fitted.
TEST(CalibrationFisheyeBoard, EveryViewIsFound) {
    const std::filesystem::path folder = shared_data() / "photos" / "fisheye_board";
    if (!std::filesystem::exists(folder)) {
        GTEST_SKIP() << "needs the photos of fisheye_board";
    }
    const scene::Chart board{.pattern = scene::Checkerboard{7, 9, 32.5}};
    for (int i = 1; i <= 15; ++i) {
        const formats::Image image = formats::read_image(folder / ("Fisheye1_" + std::to_string(i) + ".jpg"));
        const Detection detection = detect(image, board);
        ASSERT_TRUE(detection.found()) << i << ": " << detection.reason;
        EXPECT_GE(count_found(refine(image, 1, detection.points, board)), 46) << i;
    }
}

}  // namespace lensproof::calibration::fisheye_board_test
