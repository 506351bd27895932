// Photographs as cameras write them: orientation, transfer curves, EXIF, RAW.
#include "engine/formats/image/photo.h"

#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>

#include "engine/base/file.h"
#include "engine/base/input_error.h"
#include "engine/formats/image/jpeg.h"
#include "tests/complaint.h"
#include "tests/test_folder.h"

namespace lensproof::formats::photo_test {

// An 8-bit file, one byte a channel, by the library that cameras' files are read with.
std::filesystem::path write_bytes(const std::filesystem::path& file, int width, int height, int channels,
                                  const std::vector<unsigned char>& bytes, const OIIO::ImageSpec& attributes = {}) {
    OIIO::ImageSpec spec(width, height, channels, OIIO::TypeDesc::UINT8);
    spec.extra_attribs = attributes.extra_attribs;
    const auto output = OIIO::ImageOutput::create(file.string());
    EXPECT_TRUE(output && output->open(file.string(), spec) &&
                output->write_image(OIIO::TypeDesc::UINT8, bytes.data()));
    output->close();
    return file;
}

// Where EXIF 2.32's table for tag 0x0112 shows the stored pixel (x, y) of a picture of w × h.
std::pair<int, int> shown_at(int orientation, int x, int y, int w, int h) {
    switch (orientation) {
        case 2:
            return {w - 1 - x, y};
        case 3:
            return {w - 1 - x, h - 1 - y};
        case 4:
            return {x, h - 1 - y};
        case 5:
            return {y, x};
        case 6:
            return {h - 1 - y, x};
        case 7:
            return {h - 1 - y, w - 1 - x};
        case 8:
            return {y, w - 1 - x};
        default:
            return {x, y};
    }
}

// Looked at, a picture is turned; measured, it stays in the sensor's frame.
TEST(Photo, EveryOrientationIsAppliedToLookAtAndNotToMeasure) {
    const TestFolder folder;
    const std::vector<unsigned char> bytes{10, 50, 90, 130, 170, 210};
    for (int orientation = 1; orientation <= 8; ++orientation) {
        SCOPED_TRACE(orientation);
        OIIO::ImageSpec attributes;
        attributes.attribute("Orientation", orientation);
        const auto file = write_bytes(folder.path() / "turned.tif", 3, 2, 1, bytes, attributes);
        const Image seen = read_image(file);
        const Image measured = read_photo(file, std::nullopt);
        ASSERT_EQ(seen.width, orientation < 5 ? 3 : 2);
        ASSERT_EQ(seen.height, orientation < 5 ? 2 : 3);
        ASSERT_EQ(measured.width, 3);
        for (int y = 0; y < 2; ++y) {
            for (int x = 0; x < 3; ++x) {
                const auto [column, row] = shown_at(orientation, x, y, 3, 2);
                EXPECT_EQ(seen.at(column, row, 0), measured.at(x, y, 0));
            }
        }
        EXPECT_LT(measured.at(0, 0, 0), measured.at(1, 0, 0));
        EXPECT_LT(measured.at(2, 0, 0), measured.at(0, 1, 0));
        EXPECT_EQ(read_photo_header(file, std::nullopt).orientation, orientation);
    }
}

// Closed forms of IEC 61966-2-1 and BT.709-6 at half scale and below their knees; 6 digits of float.
TEST(Photo, CurvesAreThoseOfTheStandards) {
    EXPECT_NEAR(to_linear(*parse_transfer_curve("srgb"), 0.5F), std::pow(1.11 / 2.11, 2.4), 1e-6);
    EXPECT_NEAR(to_linear(*parse_transfer_curve("srgb"), 0.04F), 0.04 / 12.92, 1e-7);
    EXPECT_NEAR(to_linear(*parse_transfer_curve("rec709"), 0.5F), std::pow(0.599 / 1.099, 1.0 / 0.45), 1e-6);
    EXPECT_NEAR(to_linear(*parse_transfer_curve("rec709"), 0.08F), 0.08 / 4.5, 1e-7);
    EXPECT_NEAR(to_linear(*parse_transfer_curve("gamma:1.8"), 0.5F), std::pow(0.5, 1.8), 1e-6);
    EXPECT_EQ(to_linear(*parse_transfer_curve("linear"), 0.5F), 0.5F);
    for (const char* text : {"srgb", "rec709", "linear", "gamma:1.8"}) {
        EXPECT_EQ(to_text(*parse_transfer_curve(text)), text);
    }
    for (const char* text : {"", "sRGB2", "gamma:", "gamma:0", "gamma:nan", "gamma:2.2x"}) {
        EXPECT_FALSE(parse_transfer_curve(text)) << text;
    }
}

// The given curve is for files that state none; 16 bits keep their steps: 1/65535.
TEST(Photo, AStatedCurveWinsOverTheGivenOne) {
    const TestFolder folder;
    OIIO::ImageSpec spec(1, 1, 1, OIIO::TypeDesc::UINT16);
    const std::uint16_t half = 32768;
    const auto write = [&](const char* name) {
        std::filesystem::path file = folder.path() / name;
        const auto output = OIIO::ImageOutput::create(file.string());
        EXPECT_TRUE(output->open(file.string(), spec) && output->write_image(OIIO::TypeDesc::UINT16, &half));
        output->close();
        return file;
    };
    const auto silent = write("silent.tif");
    EXPECT_NEAR(read_photo(silent, parse_transfer_curve("linear")).at(0, 0, 0), half / 65535.0, 1e-6);
    EXPECT_NEAR(read_photo(silent, std::nullopt).at(0, 0, 0), 0.214046, 1e-5);
    spec.attribute("Exif:ColorSpace", 1);
    const auto stated = write("stated.tif");
    EXPECT_NEAR(read_photo(stated, parse_transfer_curve("linear")).at(0, 0, 0), 0.214046, 1e-5);
    EXPECT_EQ(read_photo_header(stated, std::nullopt).notes.transfer, "srgb (stated by the file)");
}

// What a camera notes comes back, with the pixel pitch of its focal plane (2500 pixels a cm: 4 µm) and its crop factor.
TEST(Photo, NotesAreRead) {
    const TestFolder folder;
    OIIO::ImageSpec notes;
    notes.attribute("Make", "Maker");
    notes.attribute("Model", "Model 1");
    notes.attribute("Exif:LensModel", "18-55mm");
    notes.attribute("Exif:FocalLength", 18.0F);
    notes.attribute("Exif:FocalLengthIn35mmFilm", 27);
    notes.attribute("FNumber", 5.6F);
    notes.attribute("ExposureTime", 0.008F);
    notes.attribute("Exif:PhotographicSensitivity", 200);
    notes.attribute("Exif:FocalPlaneXResolution", 2500.0F);
    notes.attribute("Exif:FocalPlaneResolutionUnit", 3);
    notes.attribute("Exif:CustomRendered", 1);
    const auto file =
        write_bytes(folder.path() / "a.jpg", 16, 8, 3, std::vector<unsigned char>(std::size_t{16} * 8 * 3, 99), notes);
    const PhotoHeader header = read_photo_header(file, std::nullopt);
    EXPECT_EQ(header.width, 16);
    EXPECT_EQ(header.notes.make, "Maker");
    EXPECT_EQ(header.notes.model, "Model 1");
    EXPECT_EQ(header.notes.lens, "18-55mm");
    EXPECT_EQ(header.notes.focal_length_mm, 18.0);
    EXPECT_EQ(header.notes.f_number, 5.6);
    EXPECT_EQ(header.notes.exposure_time_s, 0.008);
    EXPECT_EQ(header.notes.iso, 200.0);
    EXPECT_EQ(header.notes.pixel_pitch_um, 4.0);
    EXPECT_EQ(header.notes.crop_factor(), 1.5);
    ASSERT_EQ(header.suspicions.size(), 1u);
    EXPECT_TRUE(says(header.suspicions[0], "CustomRendered"));
}

// A DNG's entries, least significant byte first.
class DngFile {
  public:
    void entry(int tag, int type, const std::vector<std::uint32_t>& values) {
        const int size = type == 1 ? 1 : type == 3 ? 2 : 4;
        const std::size_t count = type == 5 || type == 10 ? values.size() / 2 : values.size();
        std::string data;
        for (const std::uint32_t value : values) {
            append(data, value, size);
        }
        entries_.push_back({tag, type, count, data});
    }
    void text(int tag, const std::string& words) {
        entries_.push_back({tag, 2, words.size() + 1, words + std::string(1, '\0')});
    }
    // Header, directory, what does not fit into it, then the pixels; tag 273 (StripOffsets) points to those.
    [[nodiscard]] std::string bytes(const std::string& pixels) {
        entry(273, 4, {0});
        std::ranges::sort(entries_, {}, &Entry::tag);
        std::size_t next = 8 + 2 + 12 * entries_.size() + 4;
        for (const Entry& e : entries_) {
            next += e.data.size() > 4 ? e.data.size() + e.data.size() % 2 : 0;
        }
        const std::size_t pixels_at = next;
        std::string head{"II*\0\10\0\0\0", 8};
        std::string rest;
        append(head, static_cast<std::uint32_t>(entries_.size()), 2);
        std::size_t at = 8 + 2 + 12 * entries_.size() + 4;
        for (Entry& e : entries_) {
            if (e.tag == 273) {
                e.data.clear();
                append(e.data, static_cast<std::uint32_t>(pixels_at), 4);
            }
            append(head, static_cast<std::uint32_t>(e.tag), 2);
            append(head, static_cast<std::uint32_t>(e.type), 2);
            append(head, static_cast<std::uint32_t>(e.count), 4);
            if (e.data.size() > 4) {
                append(head, static_cast<std::uint32_t>(at), 4);
                rest += e.data + std::string(e.data.size() % 2, '\0');
                at += e.data.size() + e.data.size() % 2;
            } else {
                head += e.data + std::string(4 - e.data.size(), '\0');
            }
        }
        append(head, 0, 4);
        return head + rest + pixels;
    }
    static void append(std::string& data, std::uint32_t value, int size) {
        for (int i = 0; i < size; ++i) {
            data += static_cast<char>((value >> (8U * static_cast<unsigned>(i))) & 0xFFU);
        }
    }

  private:
    struct Entry {
        int tag = 0;
        int type = 0;
        std::size_t count = 0;
        std::string data;
    };
    std::vector<Entry> entries_;
};

// A Bayer frame (RGGB) of even red, green and blue: 1/8, 1/2 and 1/4 of the way from black (512) to white (16512). Read
// back, the channels are those very fractions: no white balance (which AsShotNeutral asks for), matrix, brightening,
// curve or turning has touched them.
TEST(Photo, RawIsLinearAndAsTheSensorSawIt) {
    constexpr int kWidth = 128;
    constexpr int kHeight = 96;
    DngFile dng;
    dng.entry(254, 4, {0});
    dng.entry(256, 4, {kWidth});
    dng.entry(257, 4, {kHeight});
    dng.entry(258, 3, {16});
    dng.entry(259, 3, {1});
    dng.entry(262, 3, {32803});
    dng.text(271, "Lensproof");
    dng.text(272, "Synthetic");
    dng.entry(274, 3, {6});
    dng.entry(277, 3, {1});
    dng.entry(278, 4, {kHeight});
    dng.entry(279, 4, {2 * kWidth * kHeight});
    dng.entry(284, 3, {1});
    dng.entry(33421, 3, {2, 2});
    dng.entry(33422, 1, {0, 1, 1, 2});
    dng.entry(50706, 1, {1, 4, 0, 0});
    dng.text(50708, "Lensproof Synthetic");
    dng.entry(50714, 3, {512});
    dng.entry(50717, 4, {16512});
    dng.entry(50721, 10, {1, 1, 0, 1, 0, 1, 0, 1, 1, 1, 0, 1, 0, 1, 0, 1, 1, 1});
    dng.entry(50728, 5, {1, 2, 1, 1, 2, 3});
    std::string pixels;
    for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x) {
            const bool red = x % 2 == 0 && y % 2 == 0;
            const bool blue = x % 2 == 1 && y % 2 == 1;
            DngFile::append(pixels, red ? 2512 : blue ? 4512 : 8512, 2);
        }
    }
    const TestFolder folder;
    const auto file = folder.path() / "even.dng";
    std::ofstream(file, std::ios::binary) << dng.bytes(pixels);
    const Image image = read_photo(file, std::nullopt);
    ASSERT_EQ(image.width, kWidth);  // orientation 6 left alone
    ASSERT_EQ(image.height, kHeight);
    ASSERT_EQ(image.channel_count(), 3);
    // LibRaw scales to 16 bits: half a step of 65535, twice.
    EXPECT_NEAR(image.at(64, 48, 0), 0.125, 2e-5);
    EXPECT_NEAR(image.at(64, 48, 1), 0.5, 2e-5);
    EXPECT_NEAR(image.at(64, 48, 2), 0.25, 2e-5);
    EXPECT_EQ(read_photo_header(file, std::nullopt).notes.transfer, "linear (stated by the file)");
    EXPECT_EQ(read_photo_header(file, std::nullopt).notes.model, "Synthetic");
}

// Grey, 16 × 8 pixels of up to three bytes. The tables are libjpeg's own, which writes the file; those of low qualities
// are cut off at 255.
TEST(Photo, SaysTheQualityThatAJpegWasWrittenWith) {
    const TestFolder folder;
    for (const int quality : {5, 25, 50, 75, 90, 95, 99, 100}) {
        OIIO::ImageSpec attributes;
        attributes.attribute("compression", "jpeg:" + std::to_string(quality));
        for (const int channels : {1, 3}) {
            const auto file = write_bytes(folder.path() / (std::to_string(quality) + ".jpg"), 16, 8, channels,
                                          std::vector<unsigned char>(384, 90), attributes);
            const std::string bytes = read_file(file);
            EXPECT_EQ(jpeg_quality(bytes), quality);
            EXPECT_FALSE(jpeg_quality(bytes.substr(0, 30)));  // cut off before the table
        }
    }
    EXPECT_FALSE(jpeg_quality(""));
    EXPECT_FALSE(jpeg_quality("\x89PNG"));
}

// Quality 100 has steps of 1 in the coefficients: an even picture comes back to two steps of 255 of what it was, where
// sRGB rises by 2.2 at most.
TEST(Photo, ComesBackFromAJpegNearlyAsItWas) {
    Image image = make_image(32, 16, {"R", "G", "B"});
    std::ranges::fill(image.pixels, 0.5F);
    const Image back = after_jpeg(image, 100);
    ASSERT_EQ(back.pixels.size(), image.pixels.size());
    for (const float value : back.pixels) {
        EXPECT_NEAR(value, 0.5F, 2.0F * 2.2F / 255.0F);
    }
}

}  // namespace lensproof::formats::photo_test
