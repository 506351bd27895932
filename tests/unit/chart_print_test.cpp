#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <string>

#include "calibration/detection/detect.h"
#include "calibration/detection/refine.h"
#include "engine/io/file.h"
#include "engine/io/image.h"
#include "engine/io/input_error.h"
#include "engine/scene/chart_file.h"
#include "experiments/chart_print/chart_words.h"
#include "tests/test_folder.h"

namespace lensproof {
namespace {

Chart chart_of(const std::string& toml) {
    TomlTable top = TomlTable::parse(toml, "chart.toml");
    TomlTable table = top.table("chart");
    return read_chart(table);
}

// A pixel of the PNG shows what `is_black`, which renders the same charts, says of its middle. Cairo rounds corners and
// walks along slanting edges in fixed point, so pixels whose middle is within 0.15 px of an edge may go either way, and
// the star is left out where its sectors are narrower than a pixel (r < 3 mm).
TEST(ChartPrint, ThePictureIsTheChartThatIsRendered) {
    PrintLayout layout;
    layout.dpi = 100.0;
    const double pixel_mm = 25.4 / layout.dpi;
    const TestFolder folder;
    const std::filesystem::path file = folder.path() / "chart.png";
    for (const std::string& kind : printable_kinds()) {
        const std::string toml = chart_toml({.kind = kind}, layout);
        const Chart chart = chart_of(toml);
        EXPECT_EQ(kind_name(chart), kind);
        print_chart(chart, layout, chart_caption(toml), file);
        const Image image = read_image(file);
        ASSERT_EQ(image.width, 1169);  // 297 mm
        ASSERT_EQ(image.height, 827);
        const Vec2d centre = chart_centre_mm(layout);
        const Vec2d size = pattern_size_mm(chart);
        int wrong = 0;
        for (int y = 0; y < image.height; ++y) {
            for (int x = 0; x < image.width; ++x) {
                const Vec2d place{(x + 0.5) * pixel_mm - centre.x, (y + 0.5) * pixel_mm - centre.y};
                if (std::abs(place.x) > 0.5 * size.x || std::abs(place.y) > 0.5 * size.y) {
                    continue;  // margins and caption
                }
                if (kind == "siemens-star" && std::hypot(place.x, place.y) < 3.0) {
                    continue;
                }
                const bool black = is_black(chart, place.x, place.y);
                const double e = 0.15 * pixel_mm;
                const bool on_edge =
                    is_black(chart, place.x + e, place.y) != black || is_black(chart, place.x - e, place.y) != black ||
                    is_black(chart, place.x, place.y + e) != black || is_black(chart, place.x, place.y - e) != black;
                wrong += !on_edge && (image.at(x, y, 0) < 0.5F) != black ? 1 : 0;
            }
        }
        // Of a star's and the crosses' slanting edges 61 and 22 pixels of a million differ; why is not known.
        EXPECT_LE(wrong, kind == "siemens-star" || kind == "astigmatism-crosses" ? 96 : 0) << kind;
    }
}

// 297 × 210 mm are 841.89 × 595.276 points of 1/72 inch.
TEST(ChartPrint, VectorFormsHaveThePapersSize) {
    const PrintLayout layout;
    const std::string toml = chart_toml({.kind = "charuco"}, layout);
    const TestFolder own;
    const std::filesystem::path& folder = own.path();
    print_chart(chart_of(toml), layout, chart_caption(toml), folder / "chart.svg");
    EXPECT_NE(read_file(folder / "chart.svg").find("width=\"841.889764pt\" height=\"595.275591pt\""),
              std::string::npos);
    print_chart(chart_of(toml), layout, chart_caption(toml), folder / "chart.pdf");
    const std::string pdf = read_file(folder / "chart.pdf");
    EXPECT_EQ(pdf.substr(0, 5), "%PDF-");
    print_chart(chart_of(toml), layout, chart_caption(toml), folder / "again.pdf");
    EXPECT_EQ(read_file(folder / "again.pdf"), pdf);
}

// A chart that was written is found where it was drawn.
TEST(ChartPrint, ACharucoBoardIsFoundInItsOwnPicture) {
    PrintLayout layout;
    layout.dpi = 100.0;
    const TestFolder folder;
    const std::filesystem::path file = folder.path() / "board.png";
    const std::string toml = chart_toml({.kind = "charuco"}, layout);
    const Chart chart = chart_of(toml);
    print_chart(chart, layout, chart_caption(toml), file);
    const Image image = read_image(file);
    const Detection detection = detect(image, chart);
    ASSERT_TRUE(detection.found()) << detection.reason;
    const ChartPoints points = refine(image, 0, detection.points, chart);
    EXPECT_EQ(count_found(points), 54);
    const Vec2d centre = chart_centre_mm(layout);
    const std::vector<Vec2d> features = feature_points(chart);
    for (std::size_t i = 0; i < features.size(); ++i) {
        // Edges fall on whole pixels: half a pixel on either side.
        EXPECT_NEAR(points.image_px[i].x, (features[i].x + centre.x) / 0.254 - 0.5, 0.55);
        EXPECT_NEAR(points.image_px[i].y, (features[i].y + centre.y) / 0.254 - 0.5, 0.55);
    }
}

TEST(ChartPrint, WhatCannotBePrintedIsRefused) {
    const PrintLayout layout;
    EXPECT_THROW(chart_toml({.kind = "colour-checker"}, layout), InputError);
    EXPECT_THROW(chart_toml({.kind = "disc-grid", .numbers = {{"marker_mm", 3.0}}}, layout), InputError);
    EXPECT_THROW(chart_toml({.kind = "disc-grid", .dictionary = "DICT_4X4_50"}, layout), InputError);
    EXPECT_THROW(check_fit(Chart{.pattern = Checkerboard{10, 7, 40.0}}, layout), InputError);
    EXPECT_THROW(print_chart(Chart{.pattern = FlatField{}}, layout, "", "chart.jpg"), InputError);
    for (const char* paper : {"A6", "", "x", "200x", "x200", "1x1", "200x300mm", "nanx200"}) {
        EXPECT_THROW(parse_paper(paper), InputError) << paper;
    }
    EXPECT_EQ(parse_paper("420x297").width_mm, parse_paper("A3").width_mm);
    for (const char* size : {"", "10", "10x", "x7", "0x7", "10x7x", "-1x7", "1e1x7"}) {
        EXPECT_THROW(parse_grid_size("--squares", size), InputError) << size;
    }
}

}  // namespace
}  // namespace lensproof
