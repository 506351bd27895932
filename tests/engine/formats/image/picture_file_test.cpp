// Which files are opened, by which reader, and up to which size.
#include "engine/formats/image/picture_file.h"

#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <random>
#include <tuple>

#include "engine/base/file.h"
#include "engine/base/memory.h"
#include "engine/base/write_file.h"
#include "engine/formats/image/image.h"
#include "engine/formats/image/jpeg.h"
#include "engine/formats/image/photo.h"
#include "engine/formats/image/srgb.h"
#include "tests/complaint.h"
#include "tests/test_folder.h"

namespace lensproof::formats::picture_file_test {

constexpr int kSide = 32;

/// The bytes of a picture in the form that the extension says, by the library.
std::string bytes_of_form(const TestFolder& folder, const std::string& extension) {
    const std::filesystem::path file = folder.path() / ("made" + extension);
    const bool floats = extension == ".exr" || extension == ".hdr";
    const OIIO::ImageSpec spec(kSide, kSide, 3, floats ? OIIO::TypeDesc::FLOAT : OIIO::TypeDesc::UINT8);
    std::vector<float> values(std::size_t{kSide} * kSide * 3);
    std::mt19937 random(1);
    std::ranges::generate(values, [&] { return static_cast<float>(random() % 256) / 255.0F; });
    const auto output = OIIO::ImageOutput::create(file.string());
    EXPECT_TRUE(output && output->open(file.string(), spec) &&
                output->write_image(OIIO::TypeDesc::FLOAT, values.data()) && output->close())
        << extension;
    return read_file(file);
}

std::filesystem::path named(const TestFolder& folder, const std::string& name, const std::string& bytes) {
    std::ofstream(folder.path() / name, std::ios::binary) << bytes;
    return folder.path() / name;
}

/// A TIFF whose header promises 8-bit pixels, of which none is there.
std::string empty_tiff(std::uint32_t width, std::uint32_t height, std::uint32_t channels) {
    std::string bytes("II*\0\10\0\0\0", 8);
    const std::vector<std::pair<std::uint32_t, std::uint32_t>> entries = {
        {256, width}, {257, height}, {258, 8}, {259, 1}, {262, 1}, {273, 8}, {277, channels}, {278, height}, {279, 8}};
    const auto append = [&](std::uint32_t value, int size) {
        for (int i = 0; i < size; ++i) {
            bytes += static_cast<char>(value >> (8 * i));
        }
    };
    append(static_cast<std::uint32_t>(entries.size()), 2);
    for (const auto& [tag, value] : entries) {
        append(tag, 2);
        append(4, 2);
        append(1, 4);
        append(value, 4);
    }
    append(0, 4);
    return bytes;
}

// A name is what somebody gave; a raw one counts where the bytes leave it open.
/// At the default quality no value of a smooth picture is off by more than three of 255, and the colours of single
/// columns stay apart, as they do not where a JPEG halves their resolution.
TEST(PictureFile, AJpegToLookAtKeepsLightAndColours) {
    const TestFolder folder;
    Image image = make_image(64, 48, {"R", "G", "B"});
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            const float light = srgb_to_linear(static_cast<float>(40 + 2 * x + y) / 255.0F);
            const bool is_striped = y >= 24;
            image.at(x, y, 0) = is_striped ? (x % 2 == 0 ? 0.5F : 0.1F) : light;
            image.at(x, y, 1) = is_striped ? 0.2F : light;
            image.at(x, y, 2) = is_striped ? (x % 2 == 0 ? 0.1F : 0.5F) : light;
        }
    }
    const Image read = read_image(named(folder, "seen.jpg", encode_jpeg(image)));
    ASSERT_EQ(read.channels, image.channels);
    for (int x = 0; x < image.width; ++x) {
        EXPECT_NEAR(255.0F * linear_to_srgb(read.at(x, 10, 1)), 255.0F * linear_to_srgb(image.at(x, 10, 1)), 3.0F) << x;
        EXPECT_EQ(read.at(x, 40, 0) > read.at(x, 40, 2), x % 2 == 0) << x;
    }
}

TEST(PictureFile, IsWhatItsFirstBytesSay) {
    const TestFolder folder;
    const std::vector<std::pair<std::string, PictureForm>> forms = {{".jpg", PictureForm::jpeg},
                                                                    {".png", PictureForm::png},
                                                                    {".tif", PictureForm::tiff},
                                                                    {".exr", PictureForm::exr},
                                                                    {".hdr", PictureForm::hdr}};
    for (const auto& [extension, form] : forms) {
        const std::string bytes = bytes_of_form(folder, extension);
        for (const char* name : {"a.jpg", "a.png", "a.tif", "a.exr", "a.hdr", "a.fits", "a"}) {
            SCOPED_TRACE(extension + " named " + name);
            const auto file = named(folder, name, bytes);
            EXPECT_EQ(picture_form(file), form);
            EXPECT_EQ(read_image(file).width, kSide);
        }
        EXPECT_EQ(picture_form(named(folder, "a.dng", bytes)), form == PictureForm::tiff ? PictureForm::raw : form);
    }
    for (const std::string& bytes : {std::string("II*\0\x10\0\0\0CR\2\0", 12), std::string("FUJIFILMCCD-RAW "),
                                     std::string("\0\0\0\x18"
                                                 "ftypcrx ",
                                                 12)}) {
        EXPECT_EQ(picture_form(named(folder, "a.jpg", bytes)), PictureForm::raw);
        EXPECT_TRUE(says(complaint_about([&] { read_image(folder.path() / "a.jpg"); }), "not a picture"));
    }
}

// Good files of forms that OpenImageIO knows and the program does not advertise; its readers of some of them write
// beyond their buffers where a file is damaged. A film, a page and a text go the same way.
TEST(PictureFile, OfAnotherFormIsRefusedUnopened) {
    const TestFolder folder;
    std::vector<std::string> others = {"%PDF-1.5\n", "SIMPLE  =                    T",
                                       std::string("\0\0\0\x18"
                                                   "ftypmp42",
                                                   12),
                                       "a text", ""};
    for (const char* extension : {".bmp", ".dpx", ".fits", ".iff", ".ppm", ".rla", ".sgi", ".tga"}) {
        others.push_back(bytes_of_form(folder, extension));
    }
    for (const std::string& bytes : others) {
        for (const char* name : {"p.jpg", "p.dng", "p.exr", "p.bmp"}) {
            const auto file = named(folder, name, bytes);
            EXPECT_TRUE(says(complaint_about([&] { read_image(file); }), "not a picture")) << bytes.substr(0, 8);
            EXPECT_TRUE(says(complaint_about([&] { read_photo_header(file, std::nullopt); }), "not a picture"));
        }
    }
}

// The library makes grey of what is missing in a JPEG: whoever reads it is told instead.
TEST(PictureFile, CutOffIsRefused) {
    const TestFolder folder;
    for (const char* extension : {".jpg", ".png", ".tif", ".exr", ".hdr"}) {
        const std::string bytes = bytes_of_form(folder, extension);
        const auto file = named(folder, std::string("cut") + extension, bytes.substr(0, bytes.size() / 2));
        const std::string complaint = complaint_about([&] { read_image(file); });
        EXPECT_TRUE(says(complaint, "cut")) << extension;
        EXPECT_TRUE(says(complaint, extension == std::string(".jpg") ? "without its end" : ":"));
    }
}

// 200 scans of no byte each: a picture of 20 megapixels would take a minute.
TEST(PictureFile, GoesOverAPictureAHundredTimesAtMost) {
    const TestFolder folder;
    std::string bytes = bytes_of_form(folder, ".jpg");
    for (int i = 0; i < 200; ++i) {
        bytes.insert(bytes.size() - 2, std::string("\xFF\xDA\0\2", 4));
    }
    const auto file = named(folder, "a.jpg", bytes);
    EXPECT_TRUE(says(complaint_about([&] { read_image(file); }), "a JPEG of 201 scans, expected at most 100"));
}

// What a file of 122 bytes promises is not made room for, unless asked for; then it is what it takes that counts.
/// A TIFF of two texts: the maker's name and, of its second directory, the camera's.
std::string tiff_of_camera(const std::string& maker, const std::string& model) {
    std::string bytes("II*\0\10\0\0\0", 8);
    const auto append = [&](std::size_t value, int size) {
        for (int i = 0; i < size; ++i) {
            bytes += static_cast<char>(value >> (8 * i));
        }
    };
    for (const auto& [tag, text, next] : {std::tuple{271, maker, 26}, {272, model, 0}}) {
        append(1, 2);
        append(static_cast<std::size_t>(tag), 2);
        append(2, 2);
        append(6, 4);  // however long it is
        append(tag == 271 ? 44 : 44 + maker.size() + 1, 4);
        append(static_cast<std::size_t>(next), 4);
    }
    return bytes + maker + '\0' + model + '\0';
}

// LibRaw 0.20 appends to the name of a Hasselblad's camera, and ends the program where that leaves no room; found by
// fuzzing, and in the corpus.
TEST(PictureFile, RawHasNamesThatMayGrow) {
    const TestFolder folder;
    const auto complaint = [&](const std::string& bytes) {
        return complaint_about([&] { read_image(named(folder, "a.dng", bytes)); });
    };
    const std::string name(60, 'H');
    EXPECT_TRUE(says(complaint(tiff_of_camera("A Hasselblad's", name)), "name has 60 letters or more"));
    EXPECT_TRUE(says(complaint(tiff_of_camera("hasselblad", name.substr(0, 49))), "49 letters"));
    EXPECT_TRUE(says(complaint("IIRO" + std::string(2'000'000, 'h') + "asselblad"), "and this is none"));
    for (const std::string& sound :
         {tiff_of_camera("Hasselblad", name.substr(0, 48)), tiff_of_camera("Nobody", name)}) {
        EXPECT_FALSE(says(complaint(sound), "letters"));
    }
}

// The reader takes metadata for as long as they say that they are. A block that fits is read, as are segments of
// others; found by fuzzing, and in the corpus.
TEST(PictureFile, HasMetadataThatEndWithTheirSegment) {
    const TestFolder folder;
    const std::string bytes = encode_jpeg(make_image(16, 16, {"R", "G", "B"}));
    const auto with = [&](char marker, const std::string& content) {
        const std::size_t size = content.size() + 2;
        return bytes.substr(0, 2) + "\xFF" + marker + static_cast<char>(size / 256) + static_cast<char>(size % 256) +
               content + bytes.substr(2);
    };
    const auto complaint = [&](const std::string& file) {
        write_file(folder.path() / "a.jpg", file);
        return complaint_about([&] { read_image(folder.path() / "a.jpg"); });
    };
    constexpr char kApp1 = '\xE1';
    constexpr char kApp13 = '\xED';
    const std::string head(
        "Photoshop 3.0\0"
        "8BIM\4\4\0\0\0\0",
        24);
    const std::string block("\0\x10\x1C\2\x78\0\7caption    ", 18);
    EXPECT_EQ(complaint(with(kApp13, head + block)), "");
    EXPECT_EQ(complaint(with(kApp13, "Ducky")), "");
    EXPECT_EQ(complaint(with(kApp1, std::string("Exif\0\0", 6))), "");
    EXPECT_TRUE(
        says(complaint(with(kApp13, head + block.substr(0, 17))), "an IPTC block of 16 bytes in a segment of 41"));
    EXPECT_TRUE(says(complaint(with(kApp13, head.substr(0, 13))), "in a segment of 13"));
    EXPECT_TRUE(says(complaint(with(kApp1, "Exif")), "metadata that end within their name"));
}

TEST(PictureFile, PromisesNoMoreThanItsBytesCanHold) {
    const TestFolder folder;
    const auto bomb = named(folder, "bomb.tif", empty_tiff(14000, 14000, 8));
    const auto read = [&] { read_image(bomb); };
    EXPECT_TRUE(says(complaint_about(read), "14000 × 14000 pixels with 8 numbers each out of 122 bytes"));
    EXPECT_TRUE(says(complaint_about(read), "--largest-picture 5982"));  // 14000² · 8 · 4 bytes
    EXPECT_TRUE(says(complaint_about([&] { read_image(named(folder, "b.tif", empty_tiff(20000, 20000, 1))); }),
                     "at most 200 million"));
    largest_picture_mib() = 5000.0;
    EXPECT_TRUE(says(complaint_about(read), "take 5981 MiB, expected at most the 5000 of --largest-picture"));
    largest_picture_mib() = 3e-3;
    EXPECT_TRUE(says(complaint_about([&] { read_image(named(folder, "a.png", bytes_of_form(folder, ".png"))); }),
                     "32 × 32 pixels take"));
    largest_picture_mib() = std::nullopt;
}

// A PNG's chunk of 2 GB in a file of 4 KB; an EXR's attribute of 2 GB, and a window of 2³¹ rows, which is a table of
// 2²⁷ chunks: the library would make room for each. Where the numbers stand follows from the attributes' names and
// types before them.
TEST(PictureFile, StatesNoMoreThanThereIs) {
    const TestFolder folder;
    const std::string good = bytes_of_form(folder, ".exr");
    const std::vector<std::pair<std::string, std::size_t>> numbers = {
        {std::string("channels\0chlist\0", 16), 0},
        {std::string("dataWindow\0box2i\0\x10\0\0\0", 21), 12},
    };
    for (const auto& [before, further] : numbers) {
        std::string bytes = good;
        const std::size_t at = bytes.find(before);
        ASSERT_NE(at, std::string::npos);
        bytes.replace(at + before.size() + further, 4, "\xFF\xFF\xFF\x7E");
        const auto file = named(folder, "a.exr", bytes);
        EXPECT_TRUE(says(complaint_about([&] { read_image(file); }), "states more than there is"));
    }
    EXPECT_EQ(complaint_about([&] { read_image(named(folder, "good.exr", good)); }), "");
    const std::string png = bytes_of_form(folder, ".png");
    const auto file = named(folder, "a.png", png.substr(0, 33) + std::string("\x7F\xFF\xFF\0tEXt", 8) + png.substr(33));
    EXPECT_TRUE(says(complaint_about([&] { read_image(file); }), "states more than there is"));
}

// OpenImageIO 2.4 ends the program at such a file.
TEST(PictureFile, HasPixelsOfATypeThatThereIs) {
    const TestFolder folder;
    std::string bytes = bytes_of_form(folder, ".exr");
    const std::string channel("channels\0chlist\0", 16);
    const std::size_t at = bytes.find(channel) + channel.size() + 4;  // the size stands between
    const std::size_t type = bytes.find('\0', at) + 1;
    ASSERT_LE(bytes.at(type), 2);
    bytes[type] = 3;
    const auto file = named(folder, "a.exr", bytes);
    EXPECT_TRUE(says(complaint_about([&] { read_image(file); }), "a channel has pixels of type 3, expected 0, 1 or 2"));
}

// OpenEXR makes room for a chunk when it opens a part, of whatever width that states, and of 16 lines where it states
// no compression.
TEST(PictureFile, HasChunksThatOneMayMakeRoomFor) {
    const TestFolder folder;
    std::string bytes = bytes_of_form(folder, ".exr");
    const std::string window("dataWindow\0box2i\0\x10\0\0\0", 21);
    const auto complaint_of_width = [&](const std::string& right_edge) {
        bytes.replace(bytes.find(window) + window.size() + 8, 4, right_edge);
        const auto file = named(folder, "a.exr", bytes);
        return complaint_about([&] { read_image(file); });
    };
    EXPECT_TRUE(says(complaint_of_width({"\xFF\xFF\xFF\x0F", 4}), "MiB, expected at most 512"));
    bytes.replace(bytes.find("compression"), 1, "k");
    EXPECT_TRUE(says(complaint_of_width({"\xFF\xFF\xFF\0", 4}), "MiB, expected at most 512"));
}

// No limit is beyond the machine; a 32 × 32 picture is within every one.
TEST(PictureFile, KnowsHowMuchMemoryThereIs) {
    EXPECT_GT(memory_bytes(), 64.0 * 1024 * 1024);
    EXPECT_LT(memory_bytes(), 1e15);
}

}  // namespace lensproof::formats::picture_file_test
