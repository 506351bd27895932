#include "calibration/detection/loose_discs.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "calibration/detection/spot_centroid.h"
#include "calibration/detection/working_copy.h"
#include "engine/base/order_statistics.h"

namespace lensproof::calibration {
namespace {

constexpr double kInner = 1.25;             // radii that hold the disc and its blur
constexpr double kOuter = 1.6;              // radii of the white that W is taken from
constexpr double kLevelBlur_px = 1.0;       // added to the one, and twice to the other
constexpr double kLeastDiscDarkness = 0.3;  // of the darkness of a black disc
constexpr int kSmallestDisc_px = 20;
constexpr double kRoundness = 1.35;     // longer side of a blob's box over the shorter one
constexpr double kFillFraction = 0.65;  // of its box; π/4 of a circle or an ellipse

}  // namespace

std::optional<Vec2d> locate_disc(const formats::Image& image, int channel, const LooseDisc& expected) {
    const double radius = expected.radius_px;
    const auto spot = locate_spot(image, channel, expected.centre_px,
                                  {.inner = kInner * radius + kLevelBlur_px,
                                   .outer = kOuter * radius + 2.0 * kLevelBlur_px,
                                   .area_px = std::numbers::pi * radius * radius,
                                   .least_fraction = kLeastDiscDarkness});
    const bool is_near = spot && std::hypot(spot->centre_px.x - expected.centre_px.x,
                                            spot->centre_px.y - expected.centre_px.y) <= 0.5 * radius;
    return is_near ? std::optional(spot->centre_px) : std::nullopt;
}

std::vector<LooseDisc> find_loose_discs(const formats::Image& image, int channel) {
    formats::Image plane = formats::make_image(image.width, image.height, {"Y"});
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            plane.at(x, y, 0) = image.at(x, y, channel);
        }
    }
    const cv::Mat copy = detector_copy(plane);
    if (copy.empty()) {
        return {};
    }
    cv::Mat dark;
    const int block = std::max(3, std::min(image.width, image.height) / 3) | 1;
    cv::adaptiveThreshold(copy, dark, 255, cv::ADAPTIVE_THRESH_MEAN_C, cv::THRESH_BINARY_INV, block, 20);
    cv::Mat labels;
    cv::Mat boxes;
    cv::Mat middles;
    const int count = cv::connectedComponentsWithStats(dark, labels, boxes, middles, 4);
    std::vector<LooseDisc> blobs;
    for (int i = 1; i < count; ++i) {
        const int width = boxes.at<int>(i, cv::CC_STAT_WIDTH);
        const int height = boxes.at<int>(i, cv::CC_STAT_HEIGHT);
        const int area = boxes.at<int>(i, cv::CC_STAT_AREA);
        const bool is_round =
            std::max(width, height) <= kRoundness * std::min(width, height) && area >= kFillFraction * width * height;
        if (area >= kSmallestDisc_px && is_round) {
            blobs.push_back({{middles.at<double>(i, 0), middles.at<double>(i, 1)},
                             std::sqrt(static_cast<double>(area) / std::numbers::pi)});
        }
    }
    if (blobs.empty()) {
        return {};
    }
    std::vector<double> radii;
    radii.reserve(blobs.size());
    for (const LooseDisc& blob : blobs) {
        radii.push_back(blob.radius_px);
    }
    const double usual = median(radii);
    std::vector<LooseDisc> discs;
    for (LooseDisc blob : blobs) {
        if (blob.radius_px < 0.7 * usual || blob.radius_px > 1.4 * usual) {
            continue;
        }
        if (const auto centre = locate_disc(image, channel, blob)) {
            blob.centre_px = *centre;
            discs.push_back(blob);
        }
    }
    return discs;
}

}  // namespace lensproof::calibration
