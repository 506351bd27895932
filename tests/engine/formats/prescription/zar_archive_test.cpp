// Zemax's archives: records of both versions, packed by an encoder of the test's own, and what is none.
#include "engine/formats/prescription/zar_archive.h"

#include <gtest/gtest.h>

#include <map>
#include <random>

#include "engine/base/text_encoding.h"
#include "engine/formats/glass/shipped_glasses.h"
#include "engine/formats/prescription/load_lens.h"
#include "engine/formats/prescription/prescription_forms.h"
#include "engine/optics/lens.h"
#include "tests/complaint.h"

namespace lensproof::formats::zar_archive_test {

/// LZW as the format has it, by a table of the words themselves.
std::string packed(const std::string& text) {
    std::map<std::string, std::size_t> words;
    for (int byte = 0; byte < 256; ++byte) {
        words[std::string(1, static_cast<char>(byte))] = static_cast<std::size_t>(byte);
    }
    std::string out;
    unsigned bits = 0;
    std::size_t known = 256;  // to the decoder, which learns each word one code later
    unsigned width = 8;
    const auto put = [&](std::size_t code) {
        while (known >= std::size_t{1} << width) {
            ++width;
        }
        for (unsigned bit = width; bit-- > 0; ++bits) {
            if (bits % 8 == 0) {
                out += '\0';
            }
            out.back() = static_cast<char>(out.back() | static_cast<char>((code >> bit & 1U) << (7 - bits % 8)));
        }
        known = words.size();
    };
    std::string word;
    for (const char letter : text) {
        if (words.contains(word + letter)) {
            word += letter;
            continue;
        }
        put(words.at(word));
        words.emplace(word + letter, words.size());
        word = std::string(1, letter);
    }
    if (!word.empty()) {
        put(words.at(word));
    }
    return out;
}

std::string little_endian(std::size_t value, int bytes) {
    std::string text;
    for (int i = 0; i < bytes; ++i, value >>= 8U) {
        text += static_cast<char>(value & 0xFFU);
    }
    return text;
}

std::string record(const std::string& name, const std::string& content) {
    std::string header(0x288, '\0');
    header.replace(0, 2, "\xEC\x03");
    header.replace(0x10, 8, little_endian(content.size(), 8));
    const std::string letters = to_utf16(name).substr(2);
    return header.replace(0x30, letters.size(), letters) + content;
}

std::string old_record(const std::string& name, const std::string& content) {
    std::string header(0x14C, '\0');
    header.replace(0, 2, std::string("\xEA\x00", 2));
    header.replace(0xC, 4, little_endian(content.size(), 4));
    return header.replace(0x20, name.size(), name) + content;
}

const std::string kLens =
    "MODE SEQ\nNAME archived\nUNIT MM\nENPD 10\nWAVM 1 0.5876 1\nPWAV 1\nSURF 0\n  TYPE STANDARD\n  CURV 0\n"
    "  DISZ INFINITY\nSURF 1\n  STOP\n  TYPE STANDARD\n  CURV 0.02\n  DISZ 4\n  GLAS ENCLOSED 0 0 1.5 40\n"
    "SURF 2\n  TYPE STANDARD\n  CURV 0\n  DISZ 90\nSURF 3\n  TYPE STANDARD\n  CURV 0\n  DISZ 0\n";
// n² − 1 = 1.25 at every wavelength: n = 1.5.
const std::string kGlasses = "NM ENCLOSED 2 500000 1.5 100 0 1\nED 0 0 2 0 0\nCD 1.25 0 0 0 0 0\nLD 0.3 2.0\n";

TEST(ZarArchive, IsUnpackedAsItWasPacked) {
    std::mt19937 random(3);
    std::string mixed;
    for (int i = 0; i < 200000; ++i) {  // beyond codes of 16 bits
        mixed += static_cast<char>(random() % (i < 100000 ? 4 : 256));
    }
    for (const std::string& text : {std::string(), std::string("a"), std::string(100000, 'z'), kLens, mixed}) {
        EXPECT_EQ(unpacked({.name = "x", .packed = packed(text), .is_lzw = true}, "a.zar"), text);
    }
}

TEST(ZarArchive, ReadsTheLensWithTheGlassesInIt) {
    for (const bool is_old : {false, true}) {
        const auto make = is_old ? old_record : record;
        const std::string bytes =
            make("COATING.DAT", "words") + make("lens.ZMX.LZW", packed(to_utf16(kLens))) + make("own.AGF", kGlasses);
        const optics::Prescription prescription = parse_zar(bytes, "lens.zar");
        EXPECT_EQ(prescription.name, "archived");
        ASSERT_EQ(prescription.surfaces.size(), 2u);
        const optics::Lens lens = optics::make_lens(prescription, with_own_catalogues(shipped_glasses(), prescription));
        EXPECT_NEAR(optics::at_wavelength<double>(lens, 550.0).surfaces[0].index_after, 1.5, 1e-15);
    }
}

TEST(ZarArchive, NamesSeveralLenses) {
    const std::string bytes = record("a.zmx", kLens) + record("b.zmx", kLens);
    EXPECT_TRUE(says(complaint_about([&] { parse_zar(bytes, "two.zar"); }), "two.zar: holds 2 lenses: a.zmx, b.zmx"));
    EXPECT_TRUE(says(complaint_about([&] { parse_zar(record("x.dat", ""), "none.zar"); }), "holds 0 lenses"));
}

// Bytes that are no record, sizes beyond the file, and codes that the table does not have yet.
TEST(ZarArchive, RefusesWhatIsNone) {
    const auto why = [](const std::string& bytes) { return complaint_about([&] { parse_zar(bytes, "x.zar"); }); };
    EXPECT_TRUE(says(why("junk"), "byte 0 begins no record"));
    EXPECT_TRUE(says(why("PK\x03\x04"), "ZIP"));
    EXPECT_TRUE(says(why(record("a.zmx", kLens) + "?"), "begins no record"));
    std::string endless = record("a.zmx", "");
    endless.replace(0x10, 8, std::string(8, '\xFF'));
    EXPECT_TRUE(says(why(endless), "longer than the rest"));
    EXPECT_TRUE(says(why(record("a.zmx.lzw", "\xFF\xFF")), "no LZW stream"));
}

// A bomb: each code a byte longer than the last. 6000 codes are 18 MB in 9 kB.
TEST(ZarArchive, UnpacksNoBombs) {
    std::string letters;
    letters.resize(18'000'000, 'z');
    const std::string bomb = packed(letters);
    EXPECT_LT(bomb.size(), 10'000u);
    EXPECT_TRUE(says(complaint_about([&] { parse_zar(record("a.zmx.lzw", bomb), "bomb.zar"); }), "longer than 16 MiB"));
}

}  // namespace lensproof::formats::zar_archive_test
