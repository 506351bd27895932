#include "experiments/draw/heat_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "engine/formats/image/image.h"
#include "experiments/draw/palette.h"

namespace lensproof::draw {

namespace {

constexpr double kBarGap = 10.0;
constexpr double kBarWidth = 12.0;
constexpr double kMark = 4.0;
constexpr double kScaleTextSize = 11.0;
constexpr int kShades = 256;

/// The range, or one about it where its ends do not make one.
AxisRange usable_range(const HeatMap& map) {
    const AxisRange& range = map.range;
    const bool is_finite = std::abs(range.low) < 1e280 && std::abs(range.high) < 1e280;
    const bool is_log = map.scale == AxisScale::logarithmic;
    if (!is_finite || (is_log && !(range.high > 1e-270))) {
        return is_log ? AxisRange{1e-6, 1.0} : AxisRange{0.0, 1.0};
    }
    if (is_log) {
        return {range.low > 1e-280 && range.low < 0.99 * range.high ? range.low : 1e-6 * range.high, range.high};
    }
    const double least = std::max(1e-11 * std::max(std::abs(range.low), std::abs(range.high)), 1e-280);
    return range.high - range.low > least ? range : AxisRange{range.low - 1.0 - least, range.low + 1.0 + least};
}

/// Where a value stands in the range, 0 to 1.
double fraction_of(const HeatMap& map, double value) {
    const AxisRange range = usable_range(map);
    if (map.scale == AxisScale::linear) {
        return (value - range.low) / (range.high - range.low);
    }
    return value > range.low ? std::log(value / range.low) / std::log(range.high / range.low) : 0.0;
}

void set_pixel(formats::Image& image, int x, int y, const Vec3d& rgb) {
    image.at(x, y, 0) = static_cast<float>(rgb.x);
    image.at(x, y, 1) = static_cast<float>(rgb.y);
    image.at(x, y, 2) = static_cast<float>(rgb.z);
}

std::vector<Vec3d> shades(ColourMap colours) {
    std::vector<Vec3d> table;
    table.reserve(kShades);
    for (int i = 0; i < kShades; ++i) {
        table.push_back(map_colour(colours, i / (kShades - 1.0)));
    }
    return table;
}

Ticks bar_ticks(const HeatMap& map, double height) {
    const int most = std::clamp(static_cast<int>(height / 28.0), 2, 8);
    const AxisRange range = usable_range(map);
    return map.scale == AxisScale::linear ? linear_ticks(range.low, range.high, most)
                                          : log_ticks(range.low, range.high, most);
}

double widest(const Ticks& ticks) {
    double width = 0.0;
    for (const std::string& label : ticks.labels) {
        width = std::max(width, svg_text_width(label, kScaleTextSize));
    }
    return width;
}

std::string bar_title(const HeatMap& map, const Ticks& ticks) {
    std::string unit = map.unit;
    if (ticks.exponent != 0) {
        unit = power_of_ten_text(ticks.exponent) + (unit.empty() ? "" : " " + unit);
    }
    return unit.empty() ? map.label : map.label.empty() ? unit : map.label + " (" + unit + ")";
}

}  // namespace

AxisRange symmetric_range(const std::vector<double>& values, double least) {
    double largest = least;
    for (const double value : values) {
        if (std::isfinite(value)) {
            largest = std::max(largest, std::abs(value));
        }
    }
    return {-largest, largest};
}

void draw_heat_map(Svg& svg, const HeatMap& map, const PageBox& box) {
    if (map.columns == 0 || map.rows == 0 || map.values.size() != map.columns * map.rows) {
        return;
    }
    constexpr Vec3d kPaper{0.8796, 0.8879, 0.8963};  // kMaskColour in linear light
    const std::vector<Vec3d> table = shades(map.colours);
    const auto width = static_cast<int>(map.columns);
    const auto height = static_cast<int>(map.rows);
    formats::Image image = formats::make_image(width, height, {"R", "G", "B"});
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            // A picture's rows run downwards.
            const auto row = static_cast<std::size_t>(height - 1 - y);
            const double value = map.values[row * map.columns + static_cast<std::size_t>(x)];
            const double fraction = std::clamp(fraction_of(map, value), 0.0, 1.0);
            set_pixel(
                image, x, y,
                std::isfinite(value) ? table[static_cast<std::size_t>(std::lround(fraction * (kShades - 1)))] : kPaper);
        }
    }
    svg.picture(box, formats::encode_png(image), map.label);
}

double colour_bar_width(const HeatMap& map, double height) {
    const Ticks ticks = bar_ticks(map, height);
    const bool has_title = !bar_title(map, ticks).empty();
    return kBarGap + kBarWidth + kMark + 3.0 + widest(ticks) + (has_title ? 8.0 + kScaleTextSize : 0.0) + 8.0;
}

void draw_colour_bar(Svg& svg, const HeatMap& map, const PageBox& frame) {
    const PageBox bar{frame.x + frame.width + kBarGap, frame.y, kBarWidth, frame.height};
    formats::Image image = formats::make_image(1, kShades, {"R", "G", "B"});
    const std::vector<Vec3d> table = shades(map.colours);
    for (int i = 0; i < kShades; ++i) {
        set_pixel(image, 0, kShades - 1 - i, table[static_cast<std::size_t>(i)]);
    }
    svg.open_group("colour-bar");
    svg.picture(bar, formats::encode_png(image));
    svg.rectangle({bar.x, bar.y}, bar.width, bar.height, {.stroke = kQuiet, .width = 0.9});
    const Ticks ticks = bar_ticks(map, frame.height);
    const double right = bar.x + bar.width;
    for (std::size_t i = 0; i < ticks.major.size(); ++i) {
        const double y = bar.y + (1.0 - fraction_of(map, ticks.major[i])) * bar.height;
        svg.line({right, y}, {right + kMark, y}, {.stroke = kQuiet, .width = 0.9});
        svg.text({right + kMark + 3.0, y + 0.35 * kScaleTextSize}, ticks.labels[i],
                 {.size = kScaleTextSize, .fill = kInk, .class_name = "number"});
    }
    if (const std::string title = bar_title(map, ticks); !title.empty()) {
        svg.text({right + kMark + 3.0 + widest(ticks) + 8.0 + 0.75 * kScaleTextSize, bar.y + 0.5 * bar.height}, title,
                 {.size = kScaleTextSize,
                  .fill = kInk,
                  .anchor = SvgAnchor::middle,
                  .rotation_deg = -90.0,
                  .class_name = "axis-title"});
    }
    svg.close_group();
}

}  // namespace lensproof::draw
