#include "calibration/chromatic/mosaic.h"

#include <algorithm>
#include <array>
#include <string>

#include "engine/base/input_error.h"

namespace lensproof::calibration {
namespace {

constexpr double kWeak = 0.25;  // of the strongest colour
constexpr std::array<std::string_view, 4> kNames = {"rggb", "bggr", "grbg", "gbrg"};

// 'r', 'g' or 'b'.
char colour(MosaicPattern pattern, int x, int y) {
    return kNames.at(static_cast<std::size_t>(pattern))[static_cast<std::size_t>(2 * (y % 2) + x % 2)];
}

// What a colour's values are multiplied by; 0: too weak to be used.
struct Gains {
    double red = 0.0, green = 0.0, blue = 0.0;

    [[nodiscard]] double of(char c) const { return c == 'r' ? red : c == 'g' ? green : blue; }
};

Gains gains_of(const formats::Image& raw, MosaicPattern pattern) {
    std::array<double, 3> sum{};
    std::array<double, 3> count{};
    for (int y = 0; y < raw.height; ++y) {
        for (int x = 0; x < raw.width; ++x) {
            const char c = colour(pattern, x, y);
            const std::size_t i = c == 'r' ? 0 : c == 'g' ? 1 : 2;
            sum[i] += raw.at(x, y, 0);
            count[i] += 1.0;
        }
    }
    std::array<double, 3> gain{};
    const double strongest = std::max({sum[0] / count[0], sum[1] / count[1], sum[2] / count[2]});
    for (std::size_t i = 0; i < 3; ++i) {
        const double mean = sum[i] / count[i];
        gain[i] = mean >= kWeak * strongest && mean > 0.0 ? strongest / mean : 0.0;
    }
    return {gain[0], gain[1], gain[2]};
}

void require_mosaic(const formats::Image& raw) {
    if (raw.channel_count() != 1 || raw.width < 4 || raw.height < 4) {
        throw InputError("a mosaic of " + std::to_string(raw.width) + " × " + std::to_string(raw.height) + " with " +
                         std::to_string(raw.channel_count()) +
                         " channels: expected one channel and at least 4 × 4 pixels");
    }
}

// The sites with a gain times it; the others the mean of those around them.
formats::Image filled(const formats::Image& raw, MosaicPattern pattern, const Gains& gains) {
    formats::Image plane = formats::make_image(raw.width, raw.height, {"Y"});
    for (int y = 0; y < raw.height; ++y) {
        for (int x = 0; x < raw.width; ++x) {
            double sum = 0.0;
            double weight = 0.0;
            const bool is_own = gains.of(colour(pattern, x, y)) > 0.0;
            for (int dy = -1; dy <= 1; ++dy) {
                for (int dx = -1; dx <= 1; ++dx) {
                    const bool is_inside = x + dx >= 0 && y + dy >= 0 && x + dx < raw.width && y + dy < raw.height;
                    const double gain = is_inside ? gains.of(colour(pattern, x + dx, y + dy)) : 0.0;
                    const bool is_taken = gain > 0.0 && (is_own ? dx == 0 && dy == 0 : true);
                    if (is_taken) {
                        const double w = 1.0 / std::max(1, dx * dx + dy * dy);
                        sum += w * gain * raw.at(x + dx, y + dy, 0);
                        weight += w;
                    }
                }
            }
            plane.at(x, y, 0) = static_cast<float>(sum / weight);
        }
    }
    return plane;
}

}  // namespace

std::optional<MosaicPattern> mosaic_pattern(std::string_view name) {
    const auto found = std::find(kNames.begin(), kNames.end(), name);
    return found != kNames.end() ? std::optional(static_cast<MosaicPattern>(found - kNames.begin())) : std::nullopt;
}

formats::Image mosaic_plane(const formats::Image& raw, MosaicPattern pattern) {
    require_mosaic(raw);
    const Gains gains = gains_of(raw, pattern);
    if (!(gains.red + gains.green + gains.blue > 0.0)) {
        throw InputError("a mosaic without light: expected a picture");
    }
    return filled(raw, pattern, gains);
}

std::vector<MosaicColour> mosaic_colours(const formats::Image& raw, MosaicPattern pattern) {
    require_mosaic(raw);
    const Gains gains = gains_of(raw, pattern);
    std::string colours = "rgb";
    // The least gain is the strongest colour's.
    std::ranges::stable_sort(colours, {}, [&](char c) { return gains.of(c); });
    std::vector<MosaicColour> result;
    for (const char c : colours) {
        if (gains.of(c) > 0.0) {
            const Gains alone{.red = c == 'r' ? 1.0 : 0.0, .green = c == 'g' ? 1.0 : 0.0, .blue = c == 'b' ? 1.0 : 0.0};
            result.push_back({c, filled(raw, pattern, alone)});
        }
    }
    return result;
}

}  // namespace lensproof::calibration
