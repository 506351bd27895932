// tests/cli/compare_pictures_test.cpp — `lensproof compare A B` of pictures: keys, matching, limits, maps, refusals.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/base/file.h"
#include "engine/formats/image/image.h"
#include "tests/cli/program.h"
#include "tests/complaint.h"

namespace lensproof::compare_pictures_test {

namespace {

using Json = nlohmann::json;

/// Soft squares on grey, moved by (x, y) px and dimmed.
formats::Image scene(double x, double y, double gain = 1.0) {
    formats::Image image = formats::make_image(120, 90, {"R", "G", "B"});
    for (int row = 0; row < image.height; ++row) {
        for (int column = 0; column < image.width; ++column) {
            const double u = column - x;
            const double v = row - y;
            const double light = 0.25 + 0.1 * std::sin(0.31 * u) * std::cos(0.23 * v + 0.002 * u * v) +
                                 0.1 * std::sin(0.005 * u * u + 0.11 * v);
            for (int c = 0; c < 3; ++c) {
                image.at(column, row, c) = static_cast<float>(gain * light * (1.0 - 0.2 * c));
            }
        }
    }
    return image;
}

TEST(ComparePicturesCommand, TellsWhatTheContractNames) {
    const Workplace place;
    formats::write_exr(scene(0.0, 0.0), place.path() / "a.exr");
    formats::write_exr(scene(1.25, -0.6, 0.8), place.path() / "b.exr");
    const Json json = place.json({"compare", "a.exr", "b.exr"});
    EXPECT_EQ(json["registration"]["model"], "translation");
    EXPECT_NEAR(json["registration"]["parameters"]["shift_x_px"]["value"].get<double>(), 1.25, 0.01);
    EXPECT_NEAR(json["registration"]["parameters"]["shift_y_px"]["value"].get<double>(), -0.6, 0.01);
    EXPECT_GE(json["registration"]["parameters"]["shift_x_px"]["standard_error"].get<double>(), 0.0);
    EXPECT_LT(json["registration"]["residual_px"].get<double>(), 0.05);
    EXPECT_EQ(json["exposure"]["model"], "gain");
    EXPECT_NEAR(json["exposure"]["gains"]["G"]["value"].get<double>(), 1.25, 0.005);
    EXPECT_EQ(json["flip_range"], "high");
    EXPECT_GT(json["psnr_db"].get<double>(), 40.0);
    EXPECT_GT(json["ssim"].get<double>(), 0.99);
    EXPECT_LT(json["flip"].get<double>(), 0.05);
    EXPECT_LT(json["ciede2000_mean"].get<double>(), 1.0);
    EXPECT_GE(json["ciede2000_p99"].get<double>(), json["ciede2000_mean"].get<double>());
    EXPECT_EQ(json["curves"]["brightness_ev"]["image_height"].size(),
              json["curves"]["brightness_ev"]["difference"].size());
    EXPECT_EQ(json["differences"].size(), 3U) << "of the pictures as they are";

    const Json plain = place.json({"compare", "a.exr", "b.exr", "--registration", "none", "--exposure", "none"});
    EXPECT_EQ(plain["registration"]["model"], "none");
    EXPECT_EQ(plain["exposure"]["model"], "none");
    EXPECT_LT(plain["psnr_db"].get<double>(), json["psnr_db"].get<double>());
    const Json affine = place.json({"compare", "a.exr", "b.exr", "--registration", "affine"});
    EXPECT_EQ(affine["registration"]["parameters"].size(), 6U);
}

TEST(ComparePicturesCommand, HoldsEachNumberAgainstItsLimit) {
    const Workplace place;
    formats::write_png(scene(0.0, 0.0), place.path() / "a.png");
    formats::write_png(scene(0.0, 0.0, 0.5), place.path() / "b.png");
    const std::vector<std::string> plain{"compare", "a.png", "b.png", "--registration", "none", "--exposure", "none"};
    const auto status = [&](std::vector<std::string> more) {
        std::vector<std::string> arguments = plain;
        arguments.insert(arguments.end(), more.begin(), more.end());
        return place.run(arguments).status;
    };
    EXPECT_EQ(status({}), 0);
    EXPECT_EQ(status({"--psnr-limit", "5"}), 0);
    EXPECT_EQ(status({"--psnr-limit", "60"}), 1);
    EXPECT_EQ(status({"--ssim-limit", "0.2"}), 0);
    EXPECT_EQ(status({"--ssim-limit", "0.9999"}), 1);
    EXPECT_EQ(status({"--flip-limit", "0.9"}), 0);
    EXPECT_EQ(status({"--flip-limit", "0.001"}), 1);
    EXPECT_EQ(status({"--ciede2000-limit", "50"}), 0);
    EXPECT_EQ(status({"--ciede2000-limit", "0.1"}), 1);
    EXPECT_EQ(status({"--ciede2000-p99-limit", "0.1"}), 1);
    EXPECT_EQ(place.run({"compare", "a.png", "a.png", "--psnr-limit", "90", "--ssim-limit", "1"}).status, 0)
        << "equal pictures hold any";
    EXPECT_TRUE(place.json({"compare", "a.png", "a.png"})["psnr_db"].is_null()) << "infinite";
}

TEST(ComparePicturesCommand, DrawsMaps) {
    const Workplace place;
    formats::write_png(scene(0.0, 0.0), place.path() / "a.png");
    formats::write_png(scene(0.3, 0.0), place.path() / "b.png");
    const Json json = place.json({"compare", "a.png", "b.png", "--registration", "none", "--maps", "maps"});
    ASSERT_EQ(json["maps"].size(), 3U);
    for (const Json& map : json["maps"]) {
        const formats::Image picture = formats::read_image(place.path() / map["file"].get<std::string>());
        EXPECT_EQ(picture.width, 120);
        EXPECT_EQ(picture.height, 90);
        EXPECT_LT(map["lowest"].get<double>(), map["highest"].get<double>());
    }
}

TEST(ComparePicturesCommand, WritesAPageThatLaysThemOverEachOther) {
    const Workplace place;
    formats::write_exr(scene(0.0, 0.0), place.path() / "a.exr");
    formats::write_exr(scene(1.3, 0.0, 0.5), place.path() / "b.exr");
    const auto compared = [&](const std::string& ssim) {
        return place.run({"compare", "a.exr", "b.exr", "--report", "page.html", "--ssim-limit", ssim}).status;
    };
    EXPECT_EQ(compared("0.5"), 0);
    const std::string page = read_file(place.path() / "page.html");
    for (const char* part :
         {"A: a.exr, B: b.exr", "<span>B</span>", "<span>difference</span>", "<span>flip</span>",
          "<span>ciede2000</span>", "1 − SSIM", "shift_x_px", "lensproof compare a.exr b.exr --registration auto",
          "Brightness, B against A", "PASS</span>"}) {
        EXPECT_TRUE(says(page, part));
    }
    EXPECT_EQ(compared("0.9999999"), 1);
    EXPECT_TRUE(says(read_file(place.path() / "page.html"), "FAIL</span>"));
    EXPECT_EQ(place.run({"compare", "a.exr", "b.exr", "--report", "nowhere/page.html"}).status, 0)
        << "folders are made";
    formats::write_exr(formats::make_image(120, 90, {"U", "V"}), place.path() / "uv.exr");
    const auto refused = place.run({"compare", "uv.exr", "uv.exr", "--report", "uv.html"});
    EXPECT_EQ(refused.status, 2);
    EXPECT_TRUE(says(refused.err, "nothing for --report to show"));
    EXPECT_FALSE(std::filesystem::exists(place.path() / "uv.html"));
}

/// A slanted edge and beside it a disc of light, each `soft` px from dark to bright.
formats::Image edge_and_lamp(double soft, double radius) {
    formats::Image image = formats::make_image(160, 96, {"R", "G", "B"});
    const auto ramp = [&](double inwards) { return 0.5 + 0.5 * std::tanh(inwards / soft); };
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            const double paper = 0.5 * ramp(0.996 * (40.0 - x) + 0.09 * (y - 48.0));
            const double lamp = ramp(radius - std::hypot(x - 115.0, y - 50.0));
            for (int c = 0; c < 3; ++c) {
                image.at(x, y, c) = static_cast<float>(0.1 + paper + 0.3 * lamp);
            }
        }
    }
    return image;
}

// A ramp twice as wide has half the frequencies. The disc of a quarter more radius has the diameter that its moments
// say, and (5/4)² of the light.
TEST(ComparePicturesCommand, TellsOfEdgesAndOfPatchesOfLight) {
    const Workplace place;
    formats::write_exr(edge_and_lamp(0.8, 12.0), place.path() / "a.exr");
    formats::write_exr(edge_and_lamp(1.6, 15.0), place.path() / "b.exr");
    const std::vector<std::string> as_they_are{"compare",     "a.exr",      "b.exr",      "--registration",
                                               "none",        "--exposure", "none",       "--edge",
                                               "15,10,50,76", "--spot",     "85,20,60,60"};
    const Json json = place.json(as_they_are);
    EXPECT_EQ(json["mtf"]["edges"], 1);
    EXPECT_EQ(json["mtf"]["channel"], "G");
    EXPECT_NEAR(json["mtf"]["mtf50_ratio"]["value"].get<double>(), 0.5, 0.05);
    EXPECT_EQ(json["mtf"]["a"].size(), json["mtf"]["difference"].size());
    const Json& spot = json["spots"][0];
    EXPECT_NEAR(spot["a"]["diameter_px"]["value"].get<double>(), 24.0, 0.3);
    EXPECT_NEAR(spot["diameter_ratio"]["value"].get<double>(), 1.25, 0.02);
    EXPECT_NEAR(spot["light_ev"]["value"].get<double>(), 2.0 * std::log2(1.25), 0.02);
    EXPECT_NEAR(spot["shift_x_px"]["value"].get<double>(), 0.0, 0.01);
    EXPECT_NEAR(spot["colour_ev"]["R"]["value"].get<double>(), 0.0, 1e-6);

    std::vector<std::string> with_page = as_they_are;
    with_page.insert(with_page.end(), {"--report", "page.html"});
    const auto printed = place.run(with_page);
    EXPECT_TRUE(says(printed.out, "MTF50, B over A"));
    EXPECT_TRUE(says(printed.out, "spot, diameter"));
    for (const char* part : {"The mean of both pictures", "spot, diameter", "--spot 85,20,60,60"}) {
        EXPECT_TRUE(says(read_file(place.path() / "page.html"), part));
    }
    expect_refused(place, {"compare", "a.exr", "b.exr", "--spot", "1,2,3"}, {"--spot: found \"1,2,3\""});
    expect_refused(place, {"compare", "a.exr", "b.exr", "--spot", "150,2,30,30"}, {"--spot", "the box 150,2,30,30"});
    expect_refused(place, {"compare", "a.exr", "b.exr", "--registration", "none", "--edge", "90,60,20,20"}, {"--edge"});
}

TEST(ComparePicturesCommand, RefusesWhatCannotBeCompared) {
    const Workplace place;
    formats::write_png(scene(0.0, 0.0), place.path() / "a.png");
    formats::Image other = scene(0.0, 0.0);
    for (int y = 0; y < other.height; ++y) {
        for (int x = 0; x < other.width; ++x) {
            for (int c = 0; c < 3; ++c) {
                other.at(x, y, c) = ((x / 9 + y / 14) % 2) != 0 ? 0.6F : 0.1F;
            }
        }
    }
    formats::write_png(other, place.path() / "other.png");
    expect_refused(place, {"compare", "a.png", "other.png"},
                   {"a.png", "other.png", "no overlap", "--registration none"});
    EXPECT_EQ(place.run({"compare", "a.png", "other.png", "--registration", "none"}).status, 0);
    EXPECT_EQ(place.run({"compare", "a.png", "other.png", "--rms-limit", "0.9"}).status, 0)
        << "pictures as they are need no overlap";
    expect_refused(place, {"compare", "a.png", "other.png", "--flip-limit", "0.5", "--rms-limit", "0.9"},
                   {"--flip-limit"});
    expect_refused(place, {"compare", "a.png", "a.png", "--registration", "rubber"}, {"--registration"});
    formats::write_png(formats::make_image(8, 8, {"Y"}), place.path() / "tiny.png");
    expect_refused(place, {"compare", "tiny.png", "tiny.png", "--ssim-limit", "0.5"}, {"tiny.png", "SSIM"});
    EXPECT_EQ(place.run({"compare", "tiny.png", "tiny.png"}).status, 0);
}

// The same bytes for any number of threads.
TEST(ComparePicturesCommand, IsTheSameForAnyNumberOfThreads) {
    const Workplace place;
    formats::write_exr(scene(0.0, 0.0), place.path() / "a.exr");
    formats::write_exr(scene(1.25, -0.6, 0.8), place.path() / "b.exr");
    EXPECT_EQ(place.run({"compare", "a.exr", "b.exr", "--json", "-", "--threads", "1"}).out,
              place.run({"compare", "a.exr", "b.exr", "--json", "-", "--threads", "3"}).out);
}

}  // namespace

}  // namespace lensproof::compare_pictures_test
