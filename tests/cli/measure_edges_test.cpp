// tests/cli/measure_edges_test.cpp — sharpness from pictures without a chart, and pictures each by itself.
#include <gtest/gtest.h>

#include "calibration/self_test/simulated_chart.h"
#include "engine/formats/image/image.h"
#include "tests/calibration/synthetic.h"
#include "tests/cli/program.h"
#include "tests/complaint.h"

namespace lensproof::measure_edges_test {

using namespace calibration;
using Json = nlohmann::json;

SimulatedCamera small_camera() {
    SimulatedCamera camera{.model = BrownConrady{{410.0, 159.5, 119.5, 0, 0, 0, 0, 0}},
                           .width_px = 320,
                           .height_px = 240,
                           .channels = {{.name = "R"}, {.name = "G"}, {.name = "B"}}};
    camera.blur_px = 0.7;
    camera.read_noise = 0.004;
    return camera;
}

const scene::Chart kSquares{.pattern = scene::SlantedEdges{5, 4, 60.0, 40.0, 6.0}};
const Pose kFacing{{0.0, 0.0, 0.0}, {0.0, 0.0, 420.0}};

void write_picture(const Workplace& place, const std::string& name, std::uint32_t seed) {
    formats::write_png_16(simulate_chart(small_camera(), kFacing, kSquares, seed), place.path() / name);
}

TEST(MeasureEdges, AreFoundListedAndDrawn) {
    const Workplace place;
    write_picture(place, "photo.png", 1);
    const Outcome outcome =
        place.run({"measure", "photo.png", "--edge", "auto", "-o", "profile.json", "--plots", "plots"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_TRUE(says(outcome.out, "MTF50 tangential G"));
    EXPECT_TRUE(says(outcome.out, "geometry not measured: there is no chart"));
    const Json profile = Json::parse(place.content("profile.json"));
    const std::size_t edges = profile["sharpness"]["G"].size();
    EXPECT_GT(edges, 30u);
    const std::string csv = place.content("plots/edges.csv");
    std::size_t listed = 0;
    for (const auto& [channel, own] : profile["sharpness"].items()) {
        listed += own.size();
    }
    EXPECT_EQ(static_cast<std::size_t>(std::count(csv.begin(), csv.end(), '\n')), listed + 1);
    EXPECT_TRUE(csv.starts_with("image,channel,x_px,y_px,image_height,"));
    EXPECT_TRUE(says(place.content("plots/sharpness_G.svg"), std::to_string(edges) + " edges"));
    const std::string marked = place.content("plots/edges_photo.png.svg");
    const double first = profile["sharpness"]["G"][0]["mtf50_cycles_per_px"];
    char text[16];
    std::snprintf(text, sizeof text, ">%.3f<", first);
    EXPECT_TRUE(says(marked, text));
    EXPECT_TRUE(says(marked, "data:image/png;base64,"));
}

// Pictures of different sizes, and one that cannot be measured: each has its line, its profile and its row.
TEST(MeasureEdges, EachPictureByItself) {
    const Workplace place;
    write_picture(place, "photos/a.png", 1);
    formats::write_png(formats::make_image(64, 48, {"Y"}), place.path() / "photos/blank.png");
    const Outcome outcome = place.run(
        {"measure", "photos", "--edge", "auto", "--each", "-o", "out", "--plots", "plots", "--json", "all.json"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_TRUE(says(outcome.out, "photos/a.png: MTF50"));
    EXPECT_TRUE(says(outcome.out, "photos/blank.png: left out: "));
    const std::string summary = place.content("out/summary.csv");
    EXPECT_EQ(std::count(summary.begin(), summary.end(), '\n'), 3);
    const std::string header = summary.substr(0, summary.find('\n'));
    for (const std::string& line :
         {summary.substr(summary.find("photos/a")), summary.substr(summary.find("photos/b"))}) {
        const std::string row = line.substr(0, line.find('\n'));
        EXPECT_EQ(std::count(row.begin(), row.end(), ','), std::count(header.begin(), header.end(), ',')) << row;
    }
    EXPECT_TRUE(place.has("out/a.png.json"));
    EXPECT_FALSE(place.has("out/blank.png.json"));
    EXPECT_TRUE(place.has("plots/a.png/edges.csv"));
    const Json all = Json::parse(place.content("all.json"));
    EXPECT_EQ(all["pictures"][0]["profile"], Json::parse(place.content("out/a.png.json")));
    EXPECT_TRUE(all["pictures"][1].contains("reason"));
}

// One photo of a board that faces the camera: without a model what needs no camera, and first of all why there is
// none; with the focal length and the centre held, a camera.
TEST(MeasureEdges, ABoardThatFacesTheCamera) {
    const Workplace place;
    place.file("board.toml", "[chart]\nkind = \"checkerboard\"\nsquares = [10, 7]\nsquare_mm = 30.0\n");
    const scene::Chart board{.pattern = scene::Checkerboard{10, 7, 30.0}};
    formats::write_png_16(simulate_chart(small_camera(), kFacing, board, 2), place.path() / "board.png");
    const std::vector<std::string> command = {"measure", "board.png", "--chart", "board.toml", "--no-self-test"};
    const Outcome without = place.run(command);
    ASSERT_EQ(without.status, 0) << without.err;
    EXPECT_TRUE(without.out.starts_with("no camera: ")) << without.out;
    EXPECT_TRUE(says(without.out, "--focal-length"));
    EXPECT_TRUE(says(without.out, "distortion"));

    const auto with = [&](std::vector<std::string> more) {
        more.insert(more.begin(), command.begin(), command.end());
        return more;
    };
    const Json geometry = place.json(with({"--only", "distortion"}));
    EXPECT_EQ(geometry["not_measured"]["sharpness_over_the_field"], "was not asked for");
    EXPECT_TRUE(geometry["curves"].contains("distortion_percent"));
    expect_refused(place, with({"--only", "blur"}), {"--only", "blur", "sharpness"});
    expect_refused(place, with({"--only", "sharpness", "--flat-field", "board.png"}), {"--only", "--flat-field"});
    expect_refused(place, {"measure", "board.png", "--edge", "auto", "--only", "sharpness"}, {"--only", "--edge"});
    expect_refused(place, with({"--focal-length", "2"}), {"--focal-length", "--pixel-pitch"});
    expect_refused(place, with({"--model", "brown-conrady"}), {"1 view does not determine the focal length"});
    const Json held = place.json(with({"--focal-length", "2.05", "--pixel-pitch", "5", "--fix-centre"}));
    EXPECT_NEAR(held["model"]["parameters"]["focal_length_px"]["value"].get<double>(), 410.0, 1e-9);
    EXPECT_EQ(held["model"]["parameters"]["centre_x_px"]["value"], 159.5);
}

// Discs have no edges that could be drawn; all else is measured as ever.
TEST(MeasureEdges, SaysWhereThereAreNone) {
    const Workplace place;
    ASSERT_EQ(place.run({"chart", "disc-grid", "--dpi", "50", "-o", "discs.png", "--quiet"}).status, 0);
    const Outcome outcome =
        place.run({"measure", "discs.png", "--chart", "discs.toml", "--no-self-test", "--plots", "plots"});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_TRUE(says(outcome.err, "no edges to draw"));
    EXPECT_TRUE(says(outcome.out, "distortion"));
    EXPECT_FALSE(place.has("plots"));
}

TEST(MeasureEdges, RefusesWhatMakesNoSense) {
    const Workplace place;
    write_picture(place, "photo.png", 1);
    formats::write_png(formats::make_image(64, 48, {"Y"}), place.path() / "blank.png");
    place.file("taken", "a file");
    expect_refused(place, {"measure", "photo.png", "--edge", "auto", "--edge", "whole"}, {"--edge", "auto", "alone"});
    expect_refused(place, {"measure", "photo.png", "--edge", "some"}, {"some", "auto"});
    expect_refused(place, {"measure", "blank.png", "--edge", "auto", "--each", "-o", "out"}, {"none of 1 pictures"});
    expect_refused(place, {"measure", "photo.png", "--edge", "auto", "--each", "-o", "taken"}, {"taken", "a file"});
    expect_refused(place, {"measure", "photo.png", "--edge", "auto", "--plots", "taken"}, {"taken"});
    expect_refused(place, {"measure", "photo.png", "--edge", "auto", "--each", "--focus-positions", "1"},
                   {"--focus-positions"});
}

}  // namespace lensproof::measure_edges_test
