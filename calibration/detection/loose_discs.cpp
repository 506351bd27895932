#include "calibration/detection/loose_discs.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "calibration/detection/working_copy.h"

namespace lensproof {
namespace {

constexpr double kInner = 1.25;   // radii that hold the disc and its blur
constexpr double kOuter = 1.6;    // radii of the white that W is taken from
constexpr double kBlur_px = 1.0;  // added to both
constexpr int kSmallestArea_px = 20;
constexpr double kRoundness = 1.35;  // longer side of a blob's box over the shorter one
constexpr double kFillShare = 0.65;  // of its box; π/4 of a circle or an ellipse
constexpr int kIterations = 6;

struct Annulus {
    double inner = 0.0;
    double outer = 0.0;
};

std::optional<Vec2d> centroid(const Image& image, int channel, const Vec2d& start, const LooseDisc& disc) {
    const Annulus window{kInner * disc.radius_px + kBlur_px, kOuter * disc.radius_px + 2.0 * kBlur_px};
    const int x0 = static_cast<int>(std::ceil(start.x - window.outer));
    const int x1 = static_cast<int>(std::floor(start.x + window.outer));
    const int y0 = static_cast<int>(std::ceil(start.y - window.outer));
    const int y1 = static_cast<int>(std::floor(start.y + window.outer));
    if (x0 < 0 || y0 < 0 || x1 >= image.width || y1 >= image.height) {
        return std::nullopt;
    }
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    for (int y = y0; y <= y1; ++y) {
        for (int x = x0; x <= x1; ++x) {
            const double d = std::hypot(x - start.x, y - start.y);
            if (d > window.inner && d < window.outer) {
                const Eigen::Vector3d row(1.0, x - start.x, y - start.y);
                normal += row * row.transpose();
                right += row * static_cast<double>(image.at(x, y, channel));
            }
        }
    }
    const Eigen::Vector3d white = normal.ldlt().solve(right);
    double mass = 0.0;
    Vec2d moment;
    for (int y = y0; y <= y1; ++y) {
        for (int x = x0; x <= x1; ++x) {
            const double dx = x - start.x;
            const double dy = y - start.y;
            const double paper = white(0) + white(1) * dx + white(2) * dy;
            // A pixel at the window's rim counts by its share inside, so that a moving window moves nothing.
            const double share = std::clamp(window.inner + 0.5 - std::hypot(dx, dy), 0.0, 1.0);
            if (paper > 0.0 && share > 0.0) {
                const double darkness = share * (1.0 - image.at(x, y, channel) / paper);
                mass += darkness;
                moment = {moment.x + darkness * dx, moment.y + darkness * dy};
            }
        }
    }
    const double area = std::numbers::pi * disc.radius_px * disc.radius_px;
    if (!(mass > 0.3 * area) || !(mass < 1.5 * area)) {
        return std::nullopt;
    }
    return Vec2d{start.x + moment.x / mass, start.y + moment.y / mass};
}

}  // namespace

std::optional<Vec2d> locate_disc(const Image& image, int channel, const LooseDisc& expected) {
    std::optional<Vec2d> place = expected.centre_px;
    for (int i = 0; i < kIterations && place; ++i) {
        place = centroid(image, channel, *place, expected);
        if (place &&
            std::hypot(place->x - expected.centre_px.x, place->y - expected.centre_px.y) > 0.5 * expected.radius_px) {
            return std::nullopt;
        }
    }
    return place;
}

std::vector<LooseDisc> find_loose_discs(const Image& image, int channel) {
    Image plane = make_image(image.width, image.height, {"Y"});
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
            std::max(width, height) <= kRoundness * std::min(width, height) && area >= kFillShare * width * height;
        if (area >= kSmallestArea_px && is_round) {
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
    std::nth_element(radii.begin(), radii.begin() + static_cast<std::ptrdiff_t>(radii.size() / 2), radii.end());
    const double usual = radii[radii.size() / 2];
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

}  // namespace lensproof
