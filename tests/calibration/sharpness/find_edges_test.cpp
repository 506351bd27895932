#include "calibration/sharpness/find_edges.h"

#include <gtest/gtest.h>

#include "calibration/sharpness/sharpness_map.h"
#include "tests/calibration/sharpness/sharpness_edge.h"

namespace lensproof::calibration::find_edges_test {

using namespace synthetic;

SimulatedCamera camera_with(double blur_px) {
    SimulatedCamera camera{.model = BrownConrady{{820.0, 319.5, 239.5, 0, 0, 0, 0, 0}},
                           .width_px = 640,
                           .height_px = 480,
                           .channels = {{.name = "G"}}};
    camera.blur_px = blur_px;
    camera.read_noise = 0.004;
    return camera;
}

const scene::Chart kSquares{.pattern = scene::SlantedEdges{7, 5, 60.0, 34.0, 6.0}};
const Pose kFacing{{0.02, -0.03, 0.0}, {0.0, 0.0, 600.0}};

// Without knowing the chart: most sides of its 35 squares (each of 46 px) are found, and say how blurred they are. The
// median of n edges known to 2 % each is good to 2.5 % / √n; 2 % is the target of one.
TEST(FindEdges, OfSquaresThatNobodyToldOf) {
    for (const double blur : {0.5, 0.8, 1.6}) {
        const formats::Image image = simulate_chart(camera_with(blur), kFacing, kSquares, 3);
        const std::vector<EdgeRegion> regions = find_edges(image, 0);
        std::vector<double> measured;
        for (const EdgeRegion& region : regions) {
            const auto edge = measure_edge(image, 0, region);
            if (const auto* mtf = std::get_if<EdgeMtf>(&edge); mtf != nullptr && mtf->mtf50) {
                measured.push_back(mtf->mtf50->cycles_per_px);
            }
        }
        ASSERT_GT(measured.size(), 80u) << blur;
        std::ranges::sort(measured);
        const double truth = true_frequency(gaussian_blur(blur), 6.0, 0.5);
        EXPECT_NEAR(measured[measured.size() / 2] / truth, 1.0, 0.02) << blur;
        for (std::size_t i = 0; i < regions.size(); ++i) {  // each side once
            for (std::size_t j = 0; j < i; ++j) {
                EXPECT_GT(length(regions[i].centre_px - regions[j].centre_px), 4.0);
            }
        }
    }
}

TEST(FindEdges, NoneInNoiseNorInALineNorInAPictureOfOneTone) {
    formats::Image noise = formats::make_image(320, 240, {"G"});
    Noise draw(1);
    for (float& value : noise.pixels) {
        value = static_cast<float>(0.5 + 0.1 * draw());
    }
    EXPECT_TRUE(find_edges(noise, 0).empty());
    EXPECT_TRUE(find_edges(formats::make_image(320, 240, {"G"}), 0).empty());
    EXPECT_TRUE(find_edges(formats::make_image(3, 2, {"G"}), 0).empty());
    formats::Image line = formats::make_image(320, 240, {"G"});  // a dark line 5 px wide, tilted by 8°
    for (int y = 0; y < 240; ++y) {
        for (int x = 0; x < 320; ++x) {
            line.at(x, y, 0) = std::abs(x - 160.0 + 0.14 * (y - 120.0)) < 2.5 ? 0.1F : 0.8F;
        }
    }
    EXPECT_TRUE(find_edges(line, 0).empty());
}

// Of two halves of a frame, one twice as sharp: the map has each one's own value, whatever a few blurred edges say, and
// none where no edge is near.
TEST(SharpnessMap, SaysWhereItIsSharp) {
    const auto edge = [](double x, double y, double mtf50) {
        EdgeMtf e;
        e.centre_px = {x, y};
        e.mtf50 = MtfFrequency{.cycles_per_px = mtf50};
        return e;
    };
    std::vector<EdgeMtf> edges;
    for (int i = 0; i < 8; ++i) {
        edges.push_back(edge(60.0 + i, 120.0 + 7.0 * i, 0.4));
        edges.push_back(edge(520.0 + i, 120.0 + 7.0 * i, 0.2));
    }
    edges.push_back(edge(62.0, 140.0, 0.03));
    edges.push_back({});  // an edge without an MTF50
    const SharpnessMap map = sharpness_map(edges, 600, 300);
    const auto at = [&](double x, double y) {
        return map.mtf50_cycles_per_px[static_cast<std::size_t>(std::lround(y * (map.rows - 1))) * map.columns +
                                       static_cast<std::size_t>(std::lround(x * (map.columns - 1)))];
    };
    EXPECT_EQ(at(0.1, 0.5), 0.4);
    EXPECT_EQ(at(0.87, 0.5), 0.2);
    EXPECT_TRUE(std::isnan(at(0.5, 0.5)));
    EXPECT_TRUE(std::isnan(at(1.0, 0.0)));  // 142 px from the nearest, of 112 px
}

}  // namespace lensproof::calibration::find_edges_test
