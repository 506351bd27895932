#include "calibration/lines/edge_place.h"

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <vector>

#include "calibration/detection/working_copy.h"
#include "engine/base/angle.h"

namespace lensproof::calibration {
namespace {

constexpr double kAcrossStep_px = 0.5;
constexpr double kLeastEdgeContrast = 0.04;
constexpr double kWorstShape = 0.12;    // rms of what a blurred step leaves, of its height
constexpr double kWorstPlace_px = 0.3;  // standard error
constexpr double kSharpest_px = 0.25;   // of the Gaussian's σ
constexpr double kBluntest_px = 4.0;
constexpr std::size_t kFewestEdgeSamples = 9;
constexpr int kPlaceSteps = 25;

// Light across, one value every half pixel.
struct LightAcross {
    std::vector<double> at_px;
    std::vector<double> light;
};

LightAcross light_across(const cv::Mat& plane, const EdgePiece& piece) {
    const Vec2d across{piece.along.y, -piece.along.x};
    const int reach = static_cast<int>(std::ceil(piece.reach_px / kAcrossStep_px));
    const int half = std::max(1, static_cast<int>(std::lround(2.0 * piece.half_length_px)));
    LightAcross result;
    for (int i = -reach; i <= reach; ++i) {
        const double d = kAcrossStep_px * i;
        double sum = 0.0;
        for (int k = -half; k <= half; ++k) {
            const double t = piece.half_length_px * k / half;
            sum += light_at(plane, piece.centre_px + d * across + t * piece.along);
        }
        result.at_px.push_back(d);
        result.light.push_back(sum / (2 * half + 1));
    }
    return result;
}

bool is_inside(const cv::Mat& plane, const EdgePiece& piece) {
    const double margin = piece.reach_px + piece.half_length_px + 1.0;
    const Vec2d& c = piece.centre_px;
    return c.x > margin && c.y > margin && c.x < plane.cols - 1 - margin && c.y < plane.rows - 1 - margin;
}

// The samples from the steepest rise outwards, as far as light goes on rising or stays; none without a rise.
std::optional<LightAcross> around_the_rise(const LightAcross& all) {
    const std::size_t n = all.light.size();
    std::vector<double> slope(n, 0.0);
    for (std::size_t i = 1; i + 1 < n; ++i) {
        slope[i] = all.light[i + 1] - all.light[i - 1];
    }
    const auto steepest = std::ranges::max_element(slope);
    const double peak = *steepest;
    if (!(peak > 0.0)) {
        return std::nullopt;
    }
    const auto at = static_cast<std::size_t>(steepest - slope.begin());
    const auto walked = [&](std::size_t from, int step) {
        bool is_past = false;  // the rise is over; a second one is another edge
        std::size_t i = from;
        while (i > 0 && i + 1 < n) {
            is_past = is_past || slope[i] < 0.1 * peak;
            if (slope[i] < -0.12 * peak || (is_past && slope[i] > 0.3 * peak)) {
                break;
            }
            i = step > 0 ? i + 1 : i - 1;
        }
        return i;
    };
    const std::size_t first = walked(at, -1);
    const std::size_t last = walked(at, 1);
    LightAcross part;
    for (std::size_t i = first; i <= last; ++i) {
        part.at_px.push_back(all.at_px[i]);
        part.light.push_back(all.light[i]);
    }
    return part.light.size() < kFewestEdgeSamples ? std::nullopt : std::optional(part);
}

double normal_part(double z) {
    return 0.5 * std::erfc(-z / std::numbers::sqrt2);
}

// a, b, x, s of a + b Φ((d − x) / s).
using Step = Eigen::Vector4d;

struct StepSums {
    Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
    Eigen::Vector4d right = Eigen::Vector4d::Zero();
    double squares = 0.0;
};

StepSums sums_of(const LightAcross& across, const Step& step) {
    StepSums sums;
    for (std::size_t i = 0; i < across.light.size(); ++i) {
        const double z = (across.at_px[i] - step[2]) / step[3];
        const double density = std::exp(-0.5 * z * z) / std::sqrt(2.0 * kPi);
        const double part = normal_part(z);
        const Eigen::Vector4d gradient(1.0, part, -step[1] * density / step[3], -step[1] * density * z / step[3]);
        const double left = across.light[i] - step[0] - step[1] * part;
        sums.normal += gradient * gradient.transpose();
        sums.right += gradient * left;
        sums.squares += left * left;
    }
    return sums;
}

// Levenberg's steps; none where they do not settle on a step of a sensible blur.
std::optional<Step> fitted_step(const LightAcross& across) {
    const auto [low, high] = std::ranges::minmax(across.light);
    const auto steepest = [&] {
        std::size_t best = 1;
        for (std::size_t i = 1; i + 1 < across.light.size(); ++i) {
            if (across.light[i + 1] - across.light[i - 1] > across.light[best + 1] - across.light[best - 1]) {
                best = i;
            }
        }
        return across.at_px[best];
    };
    Step step(low, high - low, steepest(), 0.8);
    StepSums sums = sums_of(across, step);
    double damping = 1e-3;
    for (int i = 0; i < kPlaceSteps; ++i) {
        Eigen::Matrix4d normal = sums.normal;
        normal.diagonal() *= 1.0 + damping;
        const Step change = normal.inverse() * sums.right;
        Step tried = step + change;
        tried[3] = std::clamp(tried[3], 0.5 * kSharpest_px, 2.0 * kBluntest_px);
        if (!tried.allFinite()) {
            return std::nullopt;
        }
        const StepSums next = sums_of(across, tried);
        if (next.squares <= sums.squares) {
            step = tried;
            sums = next;
            damping *= 0.2;
            if (std::abs(change[2]) < 1e-5) {
                break;
            }
        } else {
            damping *= 10.0;
        }
    }
    return step;
}

}  // namespace

std::optional<EdgePlace> edge_place(const cv::Mat& plane, const EdgePiece& piece) {
    if (!is_inside(plane, piece)) {
        return std::nullopt;
    }
    const auto across = around_the_rise(light_across(plane, piece));
    const auto step = across ? fitted_step(*across) : std::nullopt;
    if (!step) {
        return std::nullopt;
    }
    const double height = (*step)[1];
    const double place = (*step)[2];
    const double blur = (*step)[3];
    const double sum = 2.0 * (*step)[0] + height;
    const bool is_between = place > across->at_px.front() && place < across->at_px.back();
    if (!(height > 0.0) || !is_between || blur < kSharpest_px || blur > kBluntest_px) {
        return std::nullopt;
    }
    const StepSums sums = sums_of(*across, *step);
    const double freedom = static_cast<double>(across->light.size()) - 4.0;
    const double variance = sums.squares / freedom;
    const double error = std::sqrt(std::max(variance * sums.normal.inverse()(2, 2), 0.0));
    const double contrast = sum > 0.0 ? height / sum : 1.0;
    if (std::sqrt(variance) > kWorstShape * height || !(error < kWorstPlace_px) || contrast < kLeastEdgeContrast) {
        return std::nullopt;
    }
    return EdgePlace{.across_px = place, .standard_error_px = error, .contrast = contrast};
}

}  // namespace lensproof::calibration
