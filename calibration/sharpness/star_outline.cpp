#include "calibration/sharpness/star_outline.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "calibration/detection/working_copy.h"
#include "engine/base/order_statistics.h"

namespace lensproof::calibration {
namespace {

constexpr int kMostEnds = 64;
constexpr double kStep_px = 0.5;
constexpr double kOutlier = 4.0;   // robust standard deviations
constexpr double kFarthest = 3.0;  // times the radius that shows the pattern
constexpr double kWithin = 0.8;    // of the present rim

// How far from the centre the black along a direction turns white for good, px: half way between what the pattern shows
// on the way and what lies beyond.
std::optional<double> end_of_black(const cv::Mat& plane, const StarMap& map, double black_angle, double sector,
                                   double from_px) {
    const Vec2d along = map.direction(black_angle);
    const Vec2d beside = map.direction(black_angle + sector);
    const auto at = [&](const Vec2d& direction, double radius) {
        return light_at(plane, {map.centre_px.x + radius * direction.x, map.centre_px.y + radius * direction.y});
    };
    const double white = at(beside, from_px);
    const double black = at(along, from_px);
    const double middle = 0.5 * (white + black);
    double before = black;
    for (double radius = from_px + kStep_px; radius < kFarthest * from_px; radius += kStep_px) {
        const double x = map.centre_px.x + radius * along.x;
        const double y = map.centre_px.y + radius * along.y;
        if (x < 0.0 || y < 0.0 || x > plane.cols - 1 || y > plane.rows - 1) {
            return std::nullopt;
        }
        const double now = at(along, radius);
        if (before < middle && now >= middle) {
            return radius - kStep_px * (now - middle) / (now - before);
        }
        before = now;
    }
    return std::nullopt;
}

}  // namespace

bool fit_rim(const cv::Mat& plane, const scene::SiemensStar& star, std::optional<double> pattern_px, StarMap& map) {
    const double sector = 2.0 * std::numbers::pi / star.sectors;
    const int pairs = star.sectors / 2;
    const int stride = std::max(1, pairs / kMostEnds);
    struct End {
        Eigen::Vector3d row;  // 1/ρ = row · (scale, g)
        double value = 0.0;
    };
    std::vector<End> ends;
    int tried = 0;
    // What A says of a circle of 1 mm; only its scale is not known yet.
    for (int i = 0; i < pairs; i += stride) {
        ++tried;
        const double angle = (2.0 * i + 0.5) * sector;
        const Vec2d along = map.direction(angle);
        const Vec2d ahead{map.centre_px.x + along.x, map.centre_px.y + along.y};
        const double from_px = pattern_px ? *pattern_px : kWithin * map.rim_px(ahead, star.radius_mm);
        if (const auto radius = end_of_black(plane, map, angle, sector, from_px)) {
            const double c = std::cos(angle);
            const double s = std::sin(angle);
            const double length = std::hypot(c * map.x_axis.x + s * map.y_axis.x, c * map.x_axis.y + s * map.y_axis.y);
            ends.push_back({Eigen::Vector3d(1.0, c, s) / length, 1.0 / *radius});
        }
    }
    if (3 * static_cast<int>(ends.size()) < tried || ends.size() < 4) {
        return false;
    }
    Eigen::Vector3d solution = Eigen::Vector3d::Zero();
    double limit = 1e300;
    for (int round = 0; round < 6; ++round) {
        Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
        Eigen::Vector3d right = Eigen::Vector3d::Zero();
        for (const End& end : ends) {
            if (std::abs(end.row.dot(solution) - end.value) < limit) {
                normal += end.row * end.row.transpose();
                right += end.value * end.row;
            }
        }
        solution = normal.ldlt().solve(right);
        std::vector<double> off;
        off.reserve(ends.size());
        for (const End& end : ends) {
            off.push_back(std::abs(end.row.dot(solution) - end.value));
        }
        limit = std::max(kOutlier * kSigmaPerMedian * median(off), 1e-12);
    }
    // 1/ρ = (1 + R g·q̂) / (R |A q̂|), the present A times a scale that is to be found.
    if (!(solution(0) > 0.0) || !(std::hypot(solution(1), solution(2)) < 0.9 * solution(0))) {
        return false;
    }
    const double scale = 1.0 / (solution(0) * star.radius_mm);
    for (Vec2d* axis : {&map.x_axis, &map.y_axis}) {
        *axis = {scale * axis->x, scale * axis->y};
    }
    map.perspective = {solution(1) / solution(0) / star.radius_mm, solution(2) / solution(0) / star.radius_mm};
    return true;
}

}  // namespace lensproof::calibration
