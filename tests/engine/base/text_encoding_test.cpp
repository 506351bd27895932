// The same words in every encoding that design programs write.
#include "engine/base/text_encoding.h"

#include <gtest/gtest.h>

namespace lensproof::text_encoding_test {

using namespace std::string_literals;

// µ is U+00B5: C2 B5 in UTF-8, B5 in Windows-1252 (The Unicode Standard, tables of those encodings).
TEST(TextEncoding, EveryEncodingBecomesTheSameUtf8) {
    const std::string text = "NAME 1 \xC2\xB5m";
    EXPECT_EQ(to_utf8(text), text);
    EXPECT_EQ(to_utf8("\xEF\xBB\xBF" + text), text);
    EXPECT_EQ(to_utf8("NAME 1 \xB5m"), text);
    const std::string little =
        "N\0A\0M\0E\0 \0"
        "1\0 \0\xB5\0m\0"s;
    const std::string big =
        "\0N\0A\0M\0E\0 \0"
        "1\0 \0\xB5\0m"s;
    EXPECT_EQ(to_utf8(little), text);
    EXPECT_EQ(to_utf8("\xFF\xFE" + little), text);
    EXPECT_EQ(to_utf8(big), text);
    EXPECT_EQ(to_utf8("\xFE\xFF" + big), text);
    EXPECT_EQ(to_utf16(text), "\xFF\xFE" + little);
}

TEST(TextEncoding, JunkIsNoError) {
    EXPECT_EQ(to_utf8(""), "");
    EXPECT_EQ(to_utf8("\xFF\xFE"s), "");
    EXPECT_EQ(to_utf8("\xFF\xFE"
                      "A"s),
              "?");  // half a unit
    EXPECT_EQ(to_utf8("\xFF\xFE\x00\xD8"
                      "A\0"s),
              "?A");                  // half a surrogate pair
    EXPECT_EQ(to_utf8("\x81"), "?");  // not in Windows-1252
    EXPECT_EQ(to_utf8(std::string(100, '\0')).size(), 100U);
    EXPECT_EQ(to_utf16("\xC2"), "\xFF\xFE?\0"s);
}

}  // namespace lensproof::text_encoding_test
