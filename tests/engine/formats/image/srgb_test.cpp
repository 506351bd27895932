#include "engine/formats/image/srgb.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

namespace lensproof::formats::srgb_test {

// The table's byte is the rounded curve's for floats of every size in (0, 1), a million of them in the order of their
// bits, and beside each of the places where a byte changes.
TEST(Srgb, BytesAreTheCurveRounded) {
    const auto expected = [](float linear) { return static_cast<int>(std::lround(255.0F * linear_to_srgb(linear))); };
    const auto last = std::bit_cast<std::uint32_t>(1.0F);
    for (std::uint32_t bits = 0; bits <= last; bits += 1021) {
        const auto linear = std::bit_cast<float>(bits);
        ASSERT_EQ(linear_to_srgb_byte(linear), expected(linear)) << linear;
    }
    for (int level = 1; level < 256; ++level) {
        float linear = srgb_to_linear((static_cast<float>(level) - 0.5F) / 255.0F);
        for (int i = 0; i < 8; ++i) {
            linear = std::nextafter(linear, 0.0F);
        }
        for (int i = 0; i < 16; ++i, linear = std::nextafter(linear, 1.0F)) {
            ASSERT_EQ(linear_to_srgb_byte(linear), expected(linear)) << level << ": " << linear;
        }
    }
}

TEST(Srgb, WhatHasNoByteIsClipped) {
    EXPECT_EQ(linear_to_srgb_byte(-0.5F), 0);
    EXPECT_EQ(linear_to_srgb_byte(7.0F), 255);
    EXPECT_EQ(linear_to_srgb_byte(std::numeric_limits<float>::infinity()), 255);
    EXPECT_EQ(linear_to_srgb_byte(std::numeric_limits<float>::quiet_NaN()), 0);
}

}  // namespace lensproof::formats::srgb_test
