// tests/cli/picture_files_test.cpp — pictures that are not what they seem, wherever the program takes one.
#include <gtest/gtest.h>

#include "engine/formats/image/image.h"
#include "tests/cli/program.h"

namespace lensproof::picture_files_test {

constexpr const char* kChart = "[chart]\nkind = \"checkerboard\"\nsquares = [12, 9]\nsquare_mm = 20.0\n";

// A bitmap named .jpg, the first bytes of a film, and a JPEG whose second half is missing: no command opens them.
TEST(PictureFiles, AreRefusedByEveryCommandAlike) {
    const Workplace place;
    place.file("chart.toml", kChart);
    formats::write_png(formats::make_image(64, 48, {"Y"}), place.path() / "good.png");
    place.file("bitmap.jpg", "BM" + std::string(200, '\1'));
    place.file("film.tif", std::string("\0\0\0\x18"
                                       "ftypmp42",
                                       12) +
                               std::string(200, '\1'));
    place.file("cut.jpg", "\xFF\xD8\xFF\xE0" + std::string(200, '\1'));
    const std::vector<std::pair<std::string, std::string>> cases = {
        {"bitmap.jpg", "not a picture"}, {"film.tif", "not a picture"}, {"cut.jpg", "cut off"}};
    for (const auto& [file, reason] : cases) {
        SCOPED_TRACE(file);
        expect_refused(place, {"compare", file, "good.png"}, {file, reason});
        expect_refused(place, {"measure", file, "--chart", "chart.toml", "-o", "out.json"}, {file, reason});
        expect_refused(place, {"merge", file, "-o", "out.exr"}, {file, "not an OpenEXR file"});
    }
}

// 14 000² pixels in a kilobyte would be 2243 MiB of floats. The limit can be set otherwise.
TEST(PictureFiles, AreHeldToWhatTheirBytesCanHold) {
    const Workplace place;
    const std::string head = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 14000 +X 14000\n";
    place.file("bomb.hdr", head + std::string(1000, '\1'));
    formats::write_png(formats::make_image(64, 48, {"Y"}), place.path() / "good.png");
    expect_refused(place, {"compare", "bomb.hdr", "bomb.hdr"},
                   {"bomb.hdr: 14000 × 14000 pixels", "1053 bytes", "--largest-picture 2244"});
    expect_refused(place, {"compare", "good.png", "good.png", "--largest-picture", "0.01"},
                   {"good.png: 64 × 48 pixels take", "--largest-picture"});
    EXPECT_EQ(place.run({"compare", "good.png", "good.png", "--largest-picture", "1"}).status, 0);
    expect_refused(place, {"compare", "good.png", "good.png", "--largest-picture", "-1"}, {"--largest-picture"});
}

}  // namespace lensproof::picture_files_test
