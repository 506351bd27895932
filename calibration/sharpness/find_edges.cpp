#include "calibration/sharpness/find_edges.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "calibration/detection/line_segments.h"
#include "calibration/detection/working_copy.h"
#include "engine/base/angle.h"

namespace lensproof::calibration {
namespace {

constexpr double kLongestStretch_px = 96.0;
constexpr double kShortestStretch_px = 24.0;
constexpr double kEndMargin_px = 2.0;  // corners stay outside, and a tenth of the line
constexpr int kWidest_px = 24;         // on either side
constexpr int kNarrowest_px = 8;
constexpr double kUneven = 0.1;             // of the contrast, within a tone
constexpr double kLeastToneContrast = 0.2;  // (bright − dark) / (bright + dark); of a chart after ISO 12233 0.6
constexpr double kTiltFromAxes = 0.03;      // rad: along rows, columns and diagonals nothing can be measured
constexpr int kPartColumns = 12;            // of the frame
constexpr int kPartRows = 8;
constexpr std::size_t kMostInPart = 6;

struct Stretch {
    EdgeRegion region;
    double merit = 0.0;
};

using ProfileAcross = std::array<double, 2 * kWidest_px + 1>;

std::size_t place_of(int distance) {
    const int place = distance + kWidest_px;
    return static_cast<std::size_t>(place);
}

// The mean light at each distance across, from -kWidest_px on.
ProfileAcross profile_across(const cv::Mat& plane, const EdgeRegion& region) {
    ProfileAcross light{};
    const Vec2d normal{-region.along.y, region.along.x};
    const int reach = static_cast<int>(region.half_length_px);
    for (int d = -kWidest_px; d <= kWidest_px; ++d) {
        double sum = 0.0;
        for (int t = -reach; t <= reach; ++t) {
            sum += light_at(plane, {region.centre_px.x + t * region.along.x + d * normal.x,
                                    region.centre_px.y + t * region.along.y + d * normal.y});
        }
        light[place_of(d)] = sum / (2 * reach + 1);
    }
    return light;
}

struct Tones {
    double low_side = 0.0;  // at negative distances
    double high_side = 0.0;
    bool even = false;

    [[nodiscard]] double contrast() const {
        const double sum = low_side + high_side;
        return sum > 0.0 ? std::abs(high_side - low_side) / sum : 0.0;
    }
};

// The tones between 0.6 and 1 of the width on either side.
Tones tones(const ProfileAcross& light, int width) {
    const int from = static_cast<int>(std::ceil(0.6 * width));
    const auto at = [&](int d) { return light[place_of(d)]; };
    Tones result;
    for (int d = from; d <= width; ++d) {
        result.low_side += at(-d) / (width - from + 1);
        result.high_side += at(d) / (width - from + 1);
    }
    const double limit = kUneven * std::abs(result.high_side - result.low_side);
    result.even = true;
    for (int d = from; d <= width; ++d) {
        result.even =
            result.even && std::abs(at(-d) - result.low_side) < limit && std::abs(at(d) - result.high_side) < limit;
    }
    return result;
}

// As wide as both tones are even; none where they are nowhere.
std::optional<Stretch> widened(const cv::Mat& plane, EdgeRegion region) {
    const ProfileAcross light = profile_across(plane, region);
    for (int width = kWidest_px; width >= kNarrowest_px; --width) {
        const Tones found = tones(light, width);
        if (found.even && found.contrast() > kLeastToneContrast) {
            region.half_width_px = width;
            return Stretch{region, found.contrast() * std::sqrt(region.half_length_px)};
        }
    }
    return std::nullopt;
}

bool lies_along_pixels(const Vec2d& along) {
    const double eighth = std::remainder(std::atan2(along.y, along.x), kPi / 4);
    return std::abs(eighth) < kTiltFromAxes;
}

void add_stretches(const cv::Mat& plane, const LineSegment& line, std::vector<Stretch>& stretches) {
    const double length = length_of(line);
    const double usable = length - 2.0 * (kEndMargin_px + 0.1 * length);
    if (usable < kShortestStretch_px) {
        return;
    }
    const Vec2d along = direction_of(line);
    if (lies_along_pixels(along)) {
        return;
    }
    const int count = static_cast<int>(std::ceil(usable / kLongestStretch_px));
    for (int i = 0; i < count; ++i) {
        const double at = 0.5 * (length - usable) + (i + 0.5) * usable / count;
        const auto stretch = widened(plane, {.centre_px = line.from + at * along,
                                             .along = along,
                                             .half_length_px = 0.5 * usable / count,
                                             .half_width_px = kWidest_px});
        if (stretch) {
            stretches.push_back(*stretch);
        }
    }
}

// Whether two stretches are of one edge: a blurred edge may be found on both of its flanks.
bool overlap(const EdgeRegion& a, const EdgeRegion& b) {
    const Vec2d apart{b.centre_px.x - a.centre_px.x, b.centre_px.y - a.centre_px.y};
    const double along = std::abs(apart.x * a.along.x + apart.y * a.along.y);
    const double across = std::abs(apart.y * a.along.x - apart.x * a.along.y);
    return along < 0.8 * std::max(a.half_length_px, b.half_length_px) &&
           across < std::min(a.half_width_px, b.half_width_px);
}

}  // namespace

double tone_contrast(const formats::Image& image, int channel, const EdgeRegion& region) {
    const int width = std::clamp(static_cast<int>(region.half_width_px), kNarrowest_px, kWidest_px);
    const Tones found = tones(profile_across(channel_plane(image, channel), region), width);
    const double sum = found.low_side + found.high_side;
    return sum > 0.0 ? (found.high_side - found.low_side) / sum : 0.0;
}

std::vector<EdgeRegion> find_edges(const formats::Image& image, int channel) {
    const cv::Mat plane = channel_plane(image, channel);
    std::vector<Stretch> stretches;
    for (const LineSegment& line : find_segments(image).segments) {
        add_stretches(plane, line, stretches);
    }
    std::ranges::stable_sort(stretches, std::greater<>(), &Stretch::merit);
    std::vector<std::vector<EdgeRegion>> parts(static_cast<std::size_t>(kPartColumns) * kPartRows);
    for (const Stretch& stretch : stretches) {
        const auto part = [](double at, int size, int count) {
            return std::clamp(static_cast<int>((at + 0.5) / size * count), 0, count - 1);
        };
        const Vec2d& at = stretch.region.centre_px;
        auto& own = parts[static_cast<std::size_t>(part(at.y, image.height, kPartRows)) * kPartColumns +
                          static_cast<std::size_t>(part(at.x, image.width, kPartColumns))];
        const bool is_known =
            std::ranges::any_of(own, [&](const EdgeRegion& known) { return overlap(known, stretch.region); });
        if (own.size() < kMostInPart && !is_known) {
            own.push_back(stretch.region);
        }
    }
    std::vector<EdgeRegion> regions;
    for (const auto& part : parts) {
        regions.insert(regions.end(), part.begin(), part.end());
    }
    return regions;
}

}  // namespace lensproof::calibration
