#include "calibration/sharpness/star_phase.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>
#include <vector>

namespace lensproof::calibration {
namespace {

constexpr double kRingStep = 1.12;  // from one ring of cells to the next
constexpr int kWedges = 24;
constexpr int kFewestOnCircle = 12;
constexpr double kLeastModulation = 0.1;                               // of a cell's mean
constexpr double kHighestByRound[] = {0.1, 0.2, 0.35, 0.5, 0.5, 0.5};  // cycles per pixel, by round

// Least squares of a + b cos ψ + c sin ψ in a cell.
struct PhaseCell {
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    double x = 0.0;  // sums of the places
    double y = 0.0;

    void add(const Vec2d& p, double phase, double light) {
        const Eigen::Vector3d row(1.0, std::cos(phase), std::sin(phase));
        normal += row * row.transpose();
        right += light * row;
        x += p.x;
        y += p.y;
    }
};

}  // namespace

void fit_phase(const cv::Mat& plane, const scene::SiemensStar& star, StarMap& map) {
    using Terms = Eigen::Matrix<double, StarMap::kBendTerms, 1>;
    const double pairs = 0.5 * star.sectors;
    const EllipseOutline rim = outline(map, star.radius_mm);
    map.radius_px = rim.long_half_axis_px;
    const int reach = static_cast<int>(std::ceil(1.1 * rim.long_half_axis_px));
    const int x0 = std::max(0, static_cast<int>(rim.centre_px.x) - reach);
    const int x1 = std::min(plane.cols - 1, static_cast<int>(rim.centre_px.x) + reach);
    const int y0 = std::max(0, static_cast<int>(rim.centre_px.y) - reach);
    const int y1 = std::min(plane.rows - 1, static_cast<int>(rim.centre_px.y) + reach);
    for (const double highest : kHighestByRound) {
        std::map<std::pair<int, int>, PhaseCell> cells;
        for (int y = y0; y <= y1; ++y) {
            for (int x = x0; x <= x1; ++x) {
                const Vec2d p{static_cast<double>(x), static_cast<double>(y)};
                const Vec2d offset{(p.x - map.centre_px.x) / map.radius_px, (p.y - map.centre_px.y) / map.radius_px};
                const double radius = std::hypot(offset.x, offset.y);
                if (radius * map.radius_px < 3.0 ||
                    radius * map.radius_px > kWithinRim * map.rim_px(p, star.radius_mm) ||
                    pairs * map.angle_per_px(p) > highest * 2.0 * std::numbers::pi) {
                    continue;
                }
                const int ring = static_cast<int>(std::floor(std::log(radius) / std::log(kRingStep)));
                const double turn = std::atan2(offset.y, offset.x) / (2.0 * std::numbers::pi) + 0.5;
                const int wedge = std::min(kWedges - 1, static_cast<int>(turn * kWedges));
                cells[{ring, wedge}].add(p, pairs * map.angle(p), plane.at<float>(y, x));
            }
        }
        Eigen::Matrix<double, StarMap::kBendTerms, StarMap::kBendTerms> normal = decltype(normal)::Zero();
        Terms right = Terms::Zero();
        for (const auto& [place, cell] : cells) {
            const double count = cell.normal(0, 0);
            const Eigen::Vector3d fit = cell.normal.ldlt().solve(cell.right);
            const double modulation = std::hypot(fit(1), fit(2));
            if (count < kFewestOnCircle || !(modulation > kLeastModulation * fit(0))) {
                continue;
            }
            // The chart is a − m sin(pairs θ): black from θ = 0 on.
            const double ahead = std::atan2(-fit(1), -fit(2)) / pairs;
            const auto terms = map.bend_terms({cell.x / count, cell.y / count});
            const Eigen::Map<const Terms> row(terms.data());
            const double weight = modulation * modulation * count;
            normal += weight * row * row.transpose();
            right += weight * ahead * row;
        }
        normal.diagonal() *= 1.0 + 1e-9;
        const Terms change = normal.ldlt().solve(right);
        for (int i = 0; i < StarMap::kBendTerms && change.allFinite(); ++i) {
            map.bend[static_cast<std::size_t>(i)] += change(i);
        }
        // A centre that is off by (dx, dy) turns the picture's angles by (y dx − x dy) / ρ².
        map.centre_px.x += map.bend[1] * map.radius_px;
        map.centre_px.y -= map.bend[0] * map.radius_px;
        map.bend[0] = 0.0;
        map.bend[1] = 0.0;
    }
}

}  // namespace lensproof::calibration
