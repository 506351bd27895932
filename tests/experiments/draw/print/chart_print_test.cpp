#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>

#include "calibration/detection/detect.h"
#include "calibration/detection/refine.h"
#include "engine/base/file.h"
#include "engine/base/input_error.h"
#include "engine/formats/image/image.h"
#include "engine/scene/chart/chart_file.h"
#include "experiments/draw/print/chart_words.h"
#include "tests/test_folder.h"

namespace lensproof::draw::chart_print_test {

scene::Chart chart_of(const std::string& toml) {
    TomlTable top = TomlTable::parse(toml, "chart.toml");
    TomlTable table = top.table("chart");
    return scene::read_chart(table);
}

// A pixel of the PNG shows what `is_black`, which renders the same charts, says of its middle: every one of them.
TEST(ChartPrint, ThePictureIsTheChartThatIsRendered) {
    PrintLayout layout;
    layout.dpi = 100.0;
    const double pixel_mm = 25.4 / layout.dpi;
    const TestFolder folder;
    const std::filesystem::path file = folder.path() / "chart.png";
    for (const std::string& kind : printable_kinds()) {
        const std::string toml = chart_toml({.kind = kind}, layout);
        const scene::Chart chart = chart_of(toml);
        EXPECT_EQ(scene::kind_name(chart), kind);
        print_chart(chart, layout, chart_caption(toml), file);
        const formats::Image image = formats::read_image(file);
        ASSERT_EQ(image.width, 1169);  // 297 mm
        ASSERT_EQ(image.height, 827);
        const Vec2d centre = chart_centre_mm(layout);
        const Vec2d size = scene::pattern_size_mm(chart);
        int wrong = 0;
        for (int y = 0; y < image.height; ++y) {
            for (int x = 0; x < image.width; ++x) {
                const Vec2d place{(x + 0.5) * pixel_mm - centre.x, (y + 0.5) * pixel_mm - centre.y};
                if (std::abs(place.x) > 0.5 * size.x || std::abs(place.y) > 0.5 * size.y) {
                    continue;  // margins and caption
                }
                const bool black = scene::is_black(chart, place.x, place.y);
                wrong += (image.at(x, y, 0) < 0.5F) != black ? 1 : 0;
            }
        }
        EXPECT_EQ(wrong, 0) << kind;
    }
}

/// The page as another program's rasteriser draws it, 1 white; none where the program is not there.
std::optional<formats::Image> rasterised(const std::string& command, const std::filesystem::path& picture) {
    const int status = std::system((command + " >" + (picture.string() + ".log") + " 2>&1").c_str());
    return status == 0 && std::filesystem::exists(picture) ? std::optional(formats::read_image(picture)) : std::nullopt;
}

/// Pixels of the pattern in which a picture that shows how much of each pixel is white has the other tone than the one
/// that shows what its middle is.
int pixels_apart(const formats::Image& covered, const formats::Image& sampled, const scene::Chart& chart,
                 const PrintLayout& layout) {
    // A straight edge leaves the middle of a pixel and half of it on the same side; at the corner of a square it may
    // be a quarter, where two lines cross at any angle less. What is 0.85 off is an edge 0.35 px from where it should
    // be.
    constexpr double kApart = 0.85;
    const double pixel_mm = 25.4 / layout.dpi;
    const Vec2d centre = chart_centre_mm(layout);
    const Vec2d size = scene::pattern_size_mm(chart);
    int apart = 0;
    for (int y = 0; y < sampled.height; ++y) {
        for (int x = 0; x < sampled.width; ++x) {
            const Vec2d place{(x + 0.5) * pixel_mm - centre.x, (y + 0.5) * pixel_mm - centre.y};
            const bool in_pattern = std::abs(place.x) < 0.5 * size.x + 2.0 && std::abs(place.y) < 0.5 * size.y + 2.0;
            // In the star's middle its sectors are narrower than a pixel.
            const bool is_fine =
                std::holds_alternative<scene::SiemensStar>(chart.pattern) && std::hypot(place.x, place.y) < 4.0;
            const double tone =
                std::sqrt(std::max(0.0F, covered.at(x, y, 0)));  // near sRGB's own: 0.2 is 0.14, 0.8 0.8
            apart += in_pattern && !is_fine && std::abs(tone - sampled.at(x, y, 0)) > kApart ? 1 : 0;
        }
    }
    return apart;
}

// Poppler's rasteriser knows nothing of Cairo, nor of how a chart is rendered.
TEST(ChartPrint, ThePdfIsTheSameChartToAnotherProgram) {
    PrintLayout layout;
    layout.dpi = 100.0;
    const TestFolder folder;
    for (const std::string& kind : printable_kinds()) {
        const std::string toml = chart_toml({.kind = kind}, layout);
        const scene::Chart chart = chart_of(toml);
        const std::string stem = (folder.path() / kind).string();
        print_chart(chart, layout, chart_caption(toml), stem + ".pdf");
        print_chart(chart, layout, chart_caption(toml), stem + ".png");
        const auto seen = rasterised(fmt::format("pdftoppm -r 100 -gray -png -singlefile {0}.pdf {0}_seen", stem),
                                     stem + "_seen.png");
        if (!seen) {
            GTEST_SKIP() << "needs pdftoppm (poppler-utils)";
        }
        const formats::Image own = formats::read_image(stem + ".png");
        ASSERT_LE(std::abs(seen->width - own.width), 1);
        ASSERT_GE(seen->height, own.height);
        ASSERT_GE(seen->width, own.width);
        // Between a cross's arms a pixel's middle may be white and nearly all of the rest black.
        EXPECT_LE(pixels_apart(*seen, own, chart, layout), kind == "astigmatism-crosses" ? 4 : 0) << kind;
    }
}

// So does Chromium's, which draws 96 pixels per inch and rounds a picture's sides to pixels: here they are 960 and 720.
TEST(ChartPrint, TheSvgIsTheSameChartToABrowser) {
    const PrintLayout layout{.paper = {254.0, 190.5}, .margin_mm = 10.0, .dpi = 96.0};
    const TestFolder folder;
    for (const std::string kind : {"charuco", "siemens-star"}) {
        const std::string toml = chart_toml({.kind = kind}, layout);
        const scene::Chart chart = chart_of(toml);
        const std::string stem = (folder.path() / kind).string();
        print_chart(chart, layout, chart_caption(toml), stem + ".svg");
        print_chart(chart, layout, chart_caption(toml), stem + ".png");
        const formats::Image own = formats::read_image(stem + ".png");
        const auto seen = rasterised(
            fmt::format("chromium --headless=new --no-sandbox --disable-gpu --no-first-run --hide-scrollbars "
                        "--user-data-dir={0}-browser --window-size={1},{2} --screenshot={0}-seen.png file://{0}.svg",
                        stem, own.width, own.height),
            stem + "-seen.png");
        if (!seen) {
            GTEST_SKIP() << "needs chromium";
        }
        ASSERT_EQ(seen->width, own.width);
        ASSERT_EQ(seen->height, own.height);
        EXPECT_EQ(pixels_apart(*seen, own, chart, layout), 0) << kind;
    }
}

// PNG (ISO 15948), 11.3.5.3: pixels per metre in x and y, four bytes each, and 1 for the metre. 600 dpi are 23622.
TEST(ChartPrint, ThePngSaysHowLargeItIsOnPaper) {
    const PrintLayout layout{.paper = {50.0, 60.0}, .margin_mm = 2.0};
    const TestFolder folder;
    const scene::Chart chart{.pattern = scene::Checkerboard{4, 4, 10.0}};
    print_chart(chart, layout, "small", folder.path() / "small.png");
    const std::string bytes = read_file(folder.path() / "small.png");
    const std::size_t at = bytes.find("pHYs");
    ASSERT_NE(at, std::string::npos);
    const auto number = [&](std::size_t from) {
        unsigned value = 0;
        for (std::size_t i = from; i < from + 4; ++i) {
            value = value << 8U | static_cast<unsigned char>(bytes[i]);
        }
        return value;
    };
    EXPECT_NEAR(number(at + 4), 600.0 / 0.0254, 1.0);
    EXPECT_NEAR(number(at + 8), 600.0 / 0.0254, 1.0);
    EXPECT_EQ(bytes[at + 12], 1);
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
    const scene::Chart chart = chart_of(toml);
    print_chart(chart, layout, chart_caption(toml), file);
    const formats::Image image = formats::read_image(file);
    const calibration::Detection detection = calibration::detect(image, chart);
    ASSERT_TRUE(detection.found()) << detection.reason;
    const calibration::ChartPoints points = calibration::refine(image, 0, detection.points, chart);
    EXPECT_EQ(calibration::count_found(points), 54);
    const Vec2d centre = chart_centre_mm(layout);
    const std::vector<Vec2d> features = scene::feature_points(chart);
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
    EXPECT_THROW(check_fit(scene::Chart{.pattern = scene::Checkerboard{10, 7, 40.0}}, layout), InputError);
    EXPECT_THROW(print_chart(scene::Chart{.pattern = scene::FlatField{}}, layout, "", "chart.jpg"), InputError);
    for (const char* paper : {"A6", "", "x", "200x", "x200", "1x1", "200x300mm", "nanx200"}) {
        EXPECT_THROW(parse_paper(paper), InputError) << paper;
    }
    EXPECT_EQ(parse_paper("420x297").width_mm, parse_paper("A3").width_mm);
    for (const char* size : {"", "10", "10x", "x7", "0x7", "10x7x", "-1x7", "1e1x7"}) {
        EXPECT_THROW(parse_grid_size("--squares", size), InputError) << size;
    }
}

}  // namespace lensproof::draw::chart_print_test
