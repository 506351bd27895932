#include "engine/formats/image/srgb.h"

#include <array>
#include <bit>
#include <cstdint>
#include <limits>

namespace lensproof::formats {

namespace {

constexpr int kLevels = 256;
constexpr int kSteps = 4096;  // of light: the curve is nowhere steeper than a byte in each

int rounded_byte(float linear) {
    return static_cast<int>(std::lround(255.0F * linear_to_srgb(linear)));
}

struct ByteTable {
    std::array<float, kLevels + 1> least{};       // light that a byte begins at; behind the last never
    std::array<unsigned char, kSteps + 1> first;  // byte at the beginning of each step

    ByteTable() {
        least.back() = std::numeric_limits<float>::infinity();
        for (int level = 1; level < kLevels; ++level) {
            auto below = std::bit_cast<std::uint32_t>(0.0F);  // floats above 0 are in the order of their bits
            auto at = std::bit_cast<std::uint32_t>(1.0F);
            while (at - below > 1) {
                const std::uint32_t middle = below + (at - below) / 2;
                (rounded_byte(std::bit_cast<float>(middle)) >= level ? at : below) = middle;
            }
            least[static_cast<std::size_t>(level)] = std::bit_cast<float>(at);
        }
        for (int i = 0; i <= kSteps; ++i) {
            first[static_cast<std::size_t>(i)] =
                static_cast<unsigned char>(rounded_byte(static_cast<float>(i) / kSteps));
        }
    }
};

}  // namespace

unsigned char linear_to_srgb_byte(float linear) {
    static const ByteTable kTable;
    const float clipped = linear > 0.0F ? std::min(linear, 1.0F) : 0.0F;  // what is no number, too
    std::size_t byte = kTable.first[static_cast<std::size_t>(clipped * kSteps)];
    while (clipped >= kTable.least[byte + 1]) {
        ++byte;
    }
    return static_cast<unsigned char>(byte);
}

}  // namespace lensproof::formats
