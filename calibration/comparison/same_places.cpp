#include "calibration/comparison/same_places.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <optional>
#include <variant>

#include "calibration/detection/working_copy.h"
#include "calibration/sharpness/find_edges.h"
#include "engine/base/input_error.h"

namespace lensproof::calibration {

namespace {

/// The registration around a place of a: where b shows it, and b's pixels over a's.
struct LocalWarp {
    Vec2d at_px;
    Vec2d by_x;
    Vec2d by_y;

    [[nodiscard]] double area() const { return std::abs(by_x.x * by_y.y - by_x.y * by_y.x); }
    [[nodiscard]] Vec2d turned(const Vec2d& offset) const { return offset.x * by_x + offset.y * by_y; }
};

LocalWarp local_warp(const Registration& registration, const formats::Image& a, const Vec2d& at) {
    const FrameScale frame(a.width, a.height);
    const auto mapped = [&](double x, double y) { return frame.px(registration.warp(frame.unit(x, y))); };
    constexpr double kStep_px = 0.5;
    const auto slope = [](const Vec2d& high, const Vec2d& low) { return (high - low) / (2.0 * kStep_px); };
    return {.at_px = mapped(at.x, at.y),
            .by_x = slope(mapped(at.x + kStep_px, at.y), mapped(at.x - kStep_px, at.y)),
            .by_y = slope(mapped(at.x, at.y + kStep_px), mapped(at.x, at.y - kStep_px))};
}

std::vector<EdgeRegion> regions_of(const formats::Image& a, int channel,
                                   const std::vector<PixelRectangle>& rectangles) {
    if (rectangles.empty()) {
        return find_edges(a, channel);
    }
    std::vector<EdgeRegion> regions;
    for (PixelRectangle rectangle : rectangles) {
        if (rectangle.width == 0) {
            rectangle = {.x = 0, .y = 0, .width = a.width, .height = a.height};
        }
        const auto region = find_edge(a, channel, rectangle);
        if (const auto* refusal = std::get_if<EdgeRefusal>(&region)) {
            throw InputError(fmt::format("the edge in {},{},{},{}: {}", rectangle.x, rectangle.y, rectangle.width,
                                         rectangle.height, refusal->reason));
        }
        regions.push_back(std::get<EdgeRegion>(region));
    }
    return regions;
}

/// Frequencies times `scale`: cycles per pixel of a picture whose pixels are so much larger.
void rescale(EdgeMtf& edge, double scale) {
    for (std::optional<MtfFrequency>* level : {&edge.mtf50, &edge.mtf10}) {
        if (*level) {
            for (double MtfFrequency::*member : {&MtfFrequency::cycles_per_px, &MtfFrequency::standard_error,
                                                 &MtfFrequency::lower_95, &MtfFrequency::upper_95}) {
                (**level).*member *= scale;
            }
        }
    }
    const auto moved = [&](const std::vector<double>& curve) {
        std::vector<double> result;
        for (std::size_t i = 0; i < curve.size(); ++i) {
            const double at = std::min(static_cast<double>(i) / scale, static_cast<double>(curve.size() - 1));
            const auto below = std::min(static_cast<std::size_t>(at), curve.size() - 2);
            result.push_back(std::lerp(curve[below], curve[below + 1], at - static_cast<double>(below)));
        }
        return result;
    };
    edge.mtf = moved(edge.mtf);
    edge.mtf_standard_error = moved(edge.mtf_standard_error);
}

std::optional<EdgePair> measured_pair(const formats::Image& a, const formats::Image& b,
                                      const Registration& registration, int channel, const EdgeRegion& region) {
    const LocalWarp warp = local_warp(registration, a, region.centre_px);
    const Vec2d along = warp.turned(region.along);
    const double lengthened = std::hypot(along.x, along.y);
    const double widened = warp.area() / lengthened;  // across the edge, at right angles to it in either picture
    const EdgeRegion in_b{.centre_px = warp.at_px,
                          .along = along / lengthened,
                          .half_length_px = lengthened * region.half_length_px,
                          .half_width_px = widened * region.half_width_px};
    const auto one = measure_edge(a, channel, region);
    const auto other = measure_edge(b, channel, in_b);
    if (!std::holds_alternative<EdgeMtf>(one) || !std::holds_alternative<EdgeMtf>(other)) {
        return std::nullopt;
    }
    EdgePair pair{.a = std::get<EdgeMtf>(one), .b = std::get<EdgeMtf>(other)};
    rescale(pair.b, widened);
    return pair;
}

/// The mean, with its error from the values' scatter or from their own errors, whichever is larger.
Estimate mean_of(const std::vector<Estimate>& values) {
    const auto n = static_cast<double>(values.size());
    double sum = 0.0;
    double own = 0.0;
    for (const Estimate& one : values) {
        sum += one.value / n;
        own += one.standard_error * one.standard_error / (n * n);
    }
    double scatter = 0.0;
    for (const Estimate& one : values) {
        scatter += (one.value - sum) * (one.value - sum) / (n * std::max(1.0, n - 1.0));
    }
    return {sum, std::sqrt(std::max(own, scatter))};
}

void fill_means(SharpnessComparison& found) {
    const auto n = static_cast<double>(found.pairs.size());
    for (std::size_t i = 0; i < found.pairs.front().a.mtf.size(); ++i) {
        double a = 0.0;
        double b = 0.0;
        std::vector<Estimate> differences;
        for (const EdgePair& pair : found.pairs) {
            a += pair.a.mtf[i] / n;
            b += pair.b.mtf[i] / n;
            differences.push_back({pair.b.mtf[i] - pair.a.mtf[i],
                                   std::hypot(pair.a.mtf_standard_error[i], pair.b.mtf_standard_error[i])});
        }
        found.mtf_a.push_back(a);
        found.mtf_b.push_back(b);
        found.difference.push_back(mean_of(differences));
    }
    std::vector<Estimate> ratios;
    for (const EdgePair& pair : found.pairs) {
        if (pair.a.mtf50 && pair.b.mtf50) {
            const MtfFrequency& a = *pair.a.mtf50;
            const MtfFrequency& b = *pair.b.mtf50;
            ratios.push_back({std::log(b.cycles_per_px / a.cycles_per_px),
                              std::hypot(a.standard_error / a.cycles_per_px, b.standard_error / b.cycles_per_px)});
        }
    }
    if (!ratios.empty()) {
        const Estimate mean = mean_of(ratios);
        found.mtf50_ratio = {std::exp(mean.value), std::exp(mean.value) * mean.standard_error};
    }
}

/// The box in b around what the box in a holds.
PixelRectangle mapped_box(const Registration& registration, const formats::Image& a, const PixelRectangle& box) {
    double low_x = a.width;
    double low_y = a.height;
    double high_x = 0.0;
    double high_y = 0.0;
    for (const int x : {box.x, box.x + box.width - 1}) {
        for (const int y : {box.y, box.y + box.height - 1}) {
            const Vec2d at = local_warp(registration, a, {static_cast<double>(x), static_cast<double>(y)}).at_px;
            low_x = std::min(low_x, at.x);
            low_y = std::min(low_y, at.y);
            high_x = std::max(high_x, at.x);
            high_y = std::max(high_y, at.y);
        }
    }
    const int left = static_cast<int>(std::lround(low_x));
    const int top = static_cast<int>(std::lround(low_y));
    return {left, top, static_cast<int>(std::lround(high_x)) - left + 1,
            static_cast<int>(std::lround(high_y)) - top + 1};
}

Estimate total_of(const LightSpot& spot) {
    Estimate total{0.0, 0.0};
    for (const Estimate& light : spot.light) {
        total.value += light.value;
        total.standard_error = std::hypot(total.standard_error, light.standard_error);
    }
    return total;
}

double relative(const Estimate& estimate) {
    return estimate.standard_error / estimate.value;
}

}  // namespace

SharpnessComparison compare_sharpness(const formats::Image& a, const formats::Image& b,
                                      const Registration& registration, const std::vector<PixelRectangle>& rectangles) {
    const int channel = reference_channel(a);
    SharpnessComparison found{.channel = a.channels[static_cast<std::size_t>(channel)]};
    for (const EdgeRegion& region : regions_of(a, channel, rectangles)) {
        if (std::optional<EdgePair> pair = measured_pair(a, b, registration, channel, region)) {
            found.pairs.push_back(*std::move(pair));
        } else {
            ++found.refused;
        }
    }
    if (found.pairs.empty()) {
        throw InputError(fmt::format("of {} edges none can be measured in both pictures", found.refused));
    }
    fill_means(found);
    return found;
}

SpotPair compare_spots(const formats::Image& a, const formats::Image& b, const Registration& registration,
                       const ExposureMatch& exposure, const ClippedFrom& clipped, const PixelRectangle& box) {
    SpotPair pair{.box = box, .a = measure_spot(a, box, clipped.a)};
    pair.b = measure_spot(b, mapped_box(registration, a, box), clipped.b);
    if (exposure.is_matched) {
        for (std::size_t c = 0; c < pair.b.light.size(); ++c) {
            const double gain = exposure.gains[c].value;
            pair.b.light[c] = {gain * pair.b.light[c].value, gain * pair.b.light[c].standard_error};
        }
    }
    const LocalWarp warp = local_warp(registration, a, {pair.a.x_px.value, pair.a.y_px.value});
    const double enlarged = std::sqrt(warp.area());
    pair.shift_x_px = {pair.b.x_px.value - warp.at_px.x,
                       std::hypot(pair.b.x_px.standard_error, enlarged * pair.a.x_px.standard_error)};
    pair.shift_y_px = {pair.b.y_px.value - warp.at_px.y,
                       std::hypot(pair.b.y_px.standard_error, enlarged * pair.a.y_px.standard_error)};
    const double ratio = pair.b.diameter_px.value / (enlarged * pair.a.diameter_px.value);
    pair.diameter_ratio = {ratio, ratio * std::hypot(relative(pair.a.diameter_px), relative(pair.b.diameter_px))};
    const Estimate light_a = total_of(pair.a);
    const Estimate light_b = total_of(pair.b);
    pair.light_ev = {std::log2(light_b.value / (warp.area() * light_a.value)),
                     std::hypot(relative(light_a), relative(light_b)) / std::log(2.0)};
    const int green = reference_channel(a);
    for (int c = 0; a.channel_count() > 1 && c < a.channel_count(); ++c) {
        const Estimate one = pair.a.colour_ev(c, green);
        const Estimate other = pair.b.colour_ev(c, green);
        pair.colour_ev.push_back({other.value - one.value, std::hypot(one.standard_error, other.standard_error)});
    }
    return pair;
}

}  // namespace lensproof::calibration
