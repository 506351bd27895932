#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <utility>

#include "calibration/detection/working_copy.h"
#include "calibration/sharpness/siemens_star.h"
#include "calibration/sharpness/star_outline.h"
#include "calibration/sharpness/star_phase.h"
#include "calibration/statistics/dense_solvers.h"

namespace lensproof::calibration {
namespace {

constexpr double kStarSearchSide_px = 800.0;  // larger pictures vote in a copy of this size
constexpr double kSteep = 0.2;                // of the steepest gradients
constexpr int kMostVoters = 12000;
constexpr int kMostCandidates = 6;
constexpr double kNear_fraction = 0.03;       // of the copy's side, around a candidate that was tried
constexpr double kRadiusStep = 1.04;          // from circle to circle
constexpr double kFewestAcrossSector = 1.6;   // of a sector on the smallest circle
constexpr double kHysteresis = 0.15;          // of a circle's contrast
constexpr double kLeastCircleContrast = 0.1;  // (white - black) / (white + black) on a circle
constexpr std::size_t kFewestCircles = 3;
constexpr std::size_t kMostCircles = 12;

// The light on a circle, from +x towards +y.
std::vector<double> circle(const cv::Mat& plane, const Vec2d& centre, double radius, std::size_t count) {
    std::vector<double> light(count);
    for (std::size_t i = 0; i < count; ++i) {
        const double angle = 2.0 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(count);
        light[i] = light_at(plane, {centre.x + radius * std::cos(angle), centre.y + radius * std::sin(angle)});
    }
    return light;
}

// Where the light crosses from white to black and back, rad, ascending, the first into black; none where the circle has
// no contrast. What turns back within kHysteresis is noise.
std::vector<double> crossings(const std::vector<double>& light) {
    std::vector<double> sorted = light;
    std::ranges::sort(sorted);
    const double black = sorted[sorted.size() / 10];
    const double white = sorted[sorted.size() - 1 - sorted.size() / 10];
    if (!(white - black > kLeastCircleContrast * (white + black))) {
        return {};
    }
    const double middle = 0.5 * (white + black);
    const double margin = kHysteresis * (white - black);
    const auto count = light.size();
    std::size_t start = 0;  // on clear white
    while (start < count && light[start] < middle + margin) {
        ++start;
    }
    std::vector<double> angles;
    bool is_white = true;
    double last = 0.0;  // where the middle was last crossed
    for (std::size_t k = start + 1; k <= start + count; ++k) {
        const double before = light[(k - 1) % count];
        const double now = light[k % count];
        if ((before >= middle) != (now >= middle)) {
            last = static_cast<double>(k) - 1.0 + (before - middle) / (before - now);
        }
        if (is_white ? now < middle - margin : now > middle + margin) {
            angles.push_back(2.0 * std::numbers::pi * last / static_cast<double>(count));
            is_white = !is_white;
        }
    }
    return angles;
}

struct Circle {
    double radius = 0.0;
    std::vector<double> angles;  // of the sectors' sides, the first into black
};

// The longest run of circles that cross all sectors.
std::vector<Circle> sector_circles(const cv::Mat& plane, const Vec2d& centre, int sectors) {
    const double farthest =
        std::min(std::min(centre.x, plane.cols - 1 - centre.x), std::min(centre.y, plane.rows - 1 - centre.y));
    std::vector<Circle> best;
    std::vector<Circle> run;
    for (double radius = std::max(4.0, kFewestAcrossSector * sectors / (2.0 * std::numbers::pi)); radius < farthest;
         radius *= kRadiusStep) {
        const auto count = static_cast<std::size_t>(std::max(8.0 * sectors, 4.0 * radius));
        Circle own{radius, crossings(circle(plane, centre, radius, count))};
        if (own.angles.size() == static_cast<std::size_t>(sectors)) {
            run.push_back(std::move(own));
        } else {
            run.clear();
        }
        if (run.size() > best.size()) {
            best = run;
        }
    }
    return best;
}

// Moves the numbering of `circle` so that its sides follow those of `before`.
void follow(Circle& circle, const Circle& before) {
    const auto count = circle.angles.size();
    std::size_t best = 0;
    double least = 1e300;
    for (std::size_t shift = 0; shift < count; shift += 2) {
        const double apart = std::remainder(circle.angles[shift] - before.angles[0], 2.0 * std::numbers::pi);
        if (std::abs(apart) < least) {
            least = std::abs(apart);
            best = shift;
        }
    }
    std::rotate(circle.angles.begin(), circle.angles.begin() + static_cast<std::ptrdiff_t>(best), circle.angles.end());
}

// Centre and A from the sectors' sides: (p − c) × A q = 0 for a point p of the side along q, linear in A and c × A.
std::optional<StarMap> map_of(std::vector<Circle> circles, const Vec2d& around) {
    using Row = Eigen::Matrix<double, 6, 1>;
    Eigen::Matrix<double, 6, 6> normal = Eigen::Matrix<double, 6, 6>::Zero();
    const double unit = circles.back().radius;
    for (std::size_t i = circles.size(); i-- > 0;) {
        if (i + 1 < circles.size()) {
            follow(circles[i], circles[i + 1]);
        }
        const double sector = 2.0 * std::numbers::pi / static_cast<double>(circles[i].angles.size());
        for (std::size_t k = 0; k < circles[i].angles.size(); ++k) {
            const double radius = circles[i].radius / unit;
            const double px = radius * std::cos(circles[i].angles[k]);
            const double py = radius * std::sin(circles[i].angles[k]);
            const double qx = std::cos(sector * static_cast<double>(k));
            const double qy = std::sin(sector * static_cast<double>(k));
            Row row;
            row << -py * qx, -py * qy, px * qx, px * qy, -qx, -qy;
            normal += row * row.transpose();
        }
    }
    Row u = symmetric_eigen(normal).vectors.col(0);
    const double first = circles.back().angles[0];
    if (u(0) * std::cos(first) + u(2) * std::sin(first) < 0.0) {
        u = -u;
    }
    const double determinant = u(0) * u(3) - u(1) * u(2);
    if (!(determinant > 1e-3 * u.head<4>().squaredNorm())) {
        return std::nullopt;
    }
    // c × A = b: c_x A_1j − c_y A_0j = b_j.
    const Vec2d centre{(u(4) * -u(1) + u(5) * u(0)) / determinant, (-u(2) * u(5) + u(3) * u(4)) / determinant};
    if (!(std::hypot(centre.x, centre.y) < 0.5)) {
        return std::nullopt;
    }
    const double scale = 1.0 / u.head<4>().norm();
    return StarMap{.centre_px = {around.x + unit * centre.x, around.y + unit * centre.y},
                   .x_axis = {scale * u(0), scale * u(2)},
                   .y_axis = {scale * u(1), scale * u(3)},
                   .perspective = {},
                   .radius_px = unit};
}

// Votes for the places that the edges point at.
cv::Mat votes(const cv::Mat& plane) {
    cv::Mat dx;
    cv::Mat dy;
    cv::Sobel(plane, dx, CV_32F, 1, 0);
    cv::Sobel(plane, dy, CV_32F, 0, 1);
    cv::Mat steepness;
    cv::magnitude(dx, dy, steepness);
    double steepest = 0.0;
    cv::minMaxLoc(steepness, nullptr, &steepest);
    std::vector<cv::Point> voters;
    for (int y = 0; y < plane.rows; ++y) {
        for (int x = 0; x < plane.cols; ++x) {
            if (steepness.at<float>(y, x) > kSteep * steepest) {
                voters.emplace_back(x, y);
            }
        }
    }
    cv::Mat sum = cv::Mat::zeros(plane.size(), CV_32F);
    const std::size_t stride = voters.size() / kMostVoters + 1;
    for (std::size_t i = 0; i < voters.size(); i += stride) {
        const cv::Point& at = voters[i];
        const double length = steepness.at<float>(at);
        const Vec2d along{-dy.at<float>(at) / length, dx.at<float>(at) / length};
        for (const double sign : {-1.0, 1.0}) {
            for (double t = sign > 0.0 ? 0.0 : 1.0;; t += 1.0) {
                const cv::Point to(cvRound(at.x + sign * t * along.x), cvRound(at.y + sign * t * along.y));
                if (to.x < 0 || to.y < 0 || to.x >= sum.cols || to.y >= sum.rows) {
                    break;
                }
                sum.at<float>(to) += 1.0F;
            }
        }
    }
    cv::GaussianBlur(sum, sum, {}, 2.0);
    return sum;
}

// The star around a place, in full; or why it is none.
std::variant<StarMap, StarRefusal> star_around(const cv::Mat& plane, Vec2d place, const scene::SiemensStar& star) {
    std::optional<StarMap> map;
    for (int round = 0; round < 3; ++round) {  // circles around a better centre reach farther in and out
        std::vector<Circle> circles = sector_circles(plane, place, star.sectors);
        if (circles.size() < kFewestCircles) {
            return StarRefusal{"no circle in it crosses " + std::to_string(star.sectors) + " sectors"};
        }
        if (circles.size() > kMostCircles) {
            circles.erase(circles.begin(), circles.end() - static_cast<std::ptrdiff_t>(kMostCircles));
        }
        map = map_of(std::move(circles), place);
        if (!map) {
            return StarRefusal{"what has " + std::to_string(star.sectors) + " sectors is no star"};
        }
        place = map->centre_px;
    }
    if (!fit_rim(plane, star, map->radius_px, *map)) {
        return StarRefusal{
            "the star's rim is not seen: too much of it is outside the picture, or beside something dark"};
    }
    fit_phase(plane, star, *map);
    return fit_rim(plane, star, std::nullopt, *map) ? std::variant<StarMap, StarRefusal>(*map)
                                                    : StarRefusal{"the star has no rim"};
}

}  // namespace

std::variant<std::vector<StarMap>, StarRefusal> find_stars(const formats::Image& image, int channel,
                                                           const scene::SiemensStar& star) {
    const cv::Mat plane = channel_plane(image, channel);
    const double shrink = std::min(1.0, kStarSearchSide_px / std::max(image.width, image.height));
    cv::Mat copy;
    cv::GaussianBlur(plane, copy, {}, 1.0 / shrink);
    cv::resize(copy, copy, {}, shrink, shrink, cv::INTER_AREA);
    if (std::min(copy.cols, copy.rows) < 16) {
        return StarRefusal{"the picture is too small"};
    }
    cv::Mat sum = votes(copy);
    std::vector<StarMap> stars;
    std::string reason;
    const double scale_x = static_cast<double>(image.width) / copy.cols;
    const double scale_y = static_cast<double>(image.height) / copy.rows;
    for (int i = 0; i < kMostCandidates; ++i) {
        cv::Point peak;
        double height = 0.0;
        cv::minMaxLoc(sum, nullptr, &height, nullptr, &peak);
        if (!(height > 0.0)) {
            break;
        }
        auto found = star_around(plane, {(peak.x + 0.5) * scale_x - 0.5, (peak.y + 0.5) * scale_y - 0.5}, star);
        double covered = kNear_fraction * std::max(sum.cols, sum.rows);
        if (const auto* map = std::get_if<StarMap>(&found)) {
            stars.push_back(*map);
            covered = map->radius_px / scale_x;
        } else if (reason.empty()) {
            reason = std::get<StarRefusal>(found).reason;
        }
        cv::circle(sum, peak, static_cast<int>(std::ceil(covered)), cv::Scalar(0.0), cv::FILLED);
    }
    if (stars.empty()) {
        return StarRefusal{"no Siemens star of " + std::to_string(star.sectors) +
                           " sectors found: " + (reason.empty() ? "the picture is of one tone" : reason)};
    }
    std::ranges::sort(stars, {}, [](const StarMap& map) { return map.centre_px.x; });
    return stars;
}

}  // namespace lensproof::calibration
