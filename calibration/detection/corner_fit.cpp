#include "calibration/detection/corner_fit.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "calibration/statistics/dense_solvers.h"

namespace lensproof::calibration {
namespace {

constexpr int kCurvedFrom_px = 6;     // half window
constexpr double kLeastSlope = 0.05;  // |b| of the window's mean light
constexpr double kLeastExplained =
    0.75;  // of the window's variance; noise as strong as a third of the step leaves that
constexpr double kFirstGuard_px = 1.5;
constexpr double kGuardBlurs = 2.0;  // standard deviations; 2 % of a marker's black reach farther
constexpr double kMostGuard = 0.5;   // of the white between edge and marker
constexpr double kSmallestBlur_px = 0.25;
constexpr int kFewestInWindow = 24;  // twice the unknowns
constexpr int kMostCornerSteps = 40;
constexpr double kBlurReach = 4.0;  // standard deviations of the plane's blur

enum Parameter {
    kX,
    kY,
    kAngle1,
    kAngle2,
    kBlur,
    kLevel,
    kSlopeX,
    kSlopeY,
    kContrast,
    kCurvature1,
    kCurvature2,
    kCount
};
using Parameters = Eigen::Matrix<double, kCount, 1>;
using Normal = Eigen::Matrix<double, kCount, kCount>;

struct Pixel {
    double x = 0.0;
    double y = 0.0;
    double light = 0.0;
};

/// A step, or a line, across one direction: its value at a distance, and the derivatives by distance and blur.
struct StepProfile {
    double value = 0.0;
    double slope = 0.0;
    double by_blur = 0.0;
};

StepProfile step_at(double distance, double blur) {
    const double scale = 1.0 / (std::numbers::sqrt2 * blur);
    const double u = distance * scale;
    const double slope = 2.0 * std::numbers::inv_sqrtpi * std::exp(-u * u) * scale;
    return {.value = std::erf(u), .slope = slope, .by_blur = -slope * distance / blur};
}

StepProfile line_at(double distance, double width, double blur) {
    const StepProfile left = step_at(distance + 0.5 * width, blur);
    const StepProfile right = step_at(distance - 0.5 * width, blur);
    return {.value = 1.0 - 0.5 * (left.value - right.value),
            .slope = -0.5 * (left.slope - right.slope),
            .by_blur = -0.5 * (left.by_blur - right.by_blur)};
}

/// One factor of the model at a pixel, and its derivatives by the parameters.
struct Edge {
    double value = 0.0;
    double by_x = 0.0;
    double by_y = 0.0;
    double by_angle = 0.0;
    double by_curvature = 0.0;
    double by_blur = 0.0;
};

Edge edge_at(double dx, double dy, double angle, double curvature, double blur, double line_px) {
    const double c = std::cos(angle);
    const double s = std::sin(angle);
    const double along = c * dx + s * dy;
    const double from = c * dy - s * dx + curvature * along * along;
    const StepProfile profile = line_px > 0.0 ? line_at(from, line_px, blur) : step_at(from, blur);
    const double bend = 2.0 * curvature * along;
    return {.value = profile.value,
            .by_x = profile.slope * (s - bend * c),
            .by_y = profile.slope * (-c - bend * s),
            .by_angle = profile.slope * (-along + bend * (c * dy - s * dx)),
            .by_curvature = profile.slope * along * along,
            .by_blur = profile.by_blur};
}

/// Widths of the two lines, px; 0 for edges.
struct LineWidths {
    double first_px = 0.0;
    double second_px = 0.0;
};

/// Model minus light at a pixel, and its gradient.
double residual(const Pixel& pixel, const Parameters& p, const LineWidths& widths, Parameters& gradient) {
    const double dx = pixel.x - p[kX];
    const double dy = pixel.y - p[kY];
    const Edge first = edge_at(dx, dy, p[kAngle1], p[kCurvature1], p[kBlur], widths.first_px);
    const Edge second = edge_at(dx, dy, p[kAngle2], p[kCurvature2], p[kBlur], widths.second_px);
    const double b = p[kContrast];
    gradient[kX] = -p[kSlopeX] + b * (first.by_x * second.value + first.value * second.by_x);
    gradient[kY] = -p[kSlopeY] + b * (first.by_y * second.value + first.value * second.by_y);
    gradient[kAngle1] = b * first.by_angle * second.value;
    gradient[kAngle2] = b * first.value * second.by_angle;
    gradient[kBlur] = b * (first.by_blur * second.value + first.value * second.by_blur);
    gradient[kLevel] = 1.0;
    gradient[kSlopeX] = dx;
    gradient[kSlopeY] = dy;
    gradient[kContrast] = first.value * second.value;
    gradient[kCurvature1] = b * first.by_curvature * second.value;
    gradient[kCurvature2] = b * first.value * second.by_curvature;
    return p[kLevel] + p[kSlopeX] * dx + p[kSlopeY] * dy + b * first.value * second.value - pixel.light;
}

struct NormalSums {
    Normal normal = Normal::Zero();
    Parameters right = Parameters::Zero();
    double squares = 0.0;
};

NormalSums sums_at(const std::vector<Pixel>& pixels, const Parameters& p, const LineWidths& widths) {
    NormalSums sums;
    Parameters gradient;
    for (const Pixel& pixel : pixels) {
        const double difference = residual(pixel, p, widths, gradient);
        sums.normal.selfadjointView<Eigen::Lower>().rankUpdate(gradient);
        sums.right -= difference * gradient;
        sums.squares += difference * difference;
    }
    sums.normal.triangularView<Eigen::StrictlyUpper>() = sums.normal.transpose();
    return sums;
}

double cross(const Vec2d& a, const Vec2d& b) {
    return a.x * b.y - a.y * b.x;
}

/// Which pixels a marker may darken: those farther from both edges than it stands, less what blur carries across, in
/// the white squares (all four where `white` is 0; else where the product of the signed distances has its sign).
struct MarkerMask {
    double guard_px = 0.0;
    double white = 0.0;
};

/// The window's pixels that belong to the model.
std::vector<Pixel> pixels_of(const cv::Mat& plane, const CornerStart& start, const MarkerMask& mask) {
    const int x = static_cast<int>(std::lround(start.corner_px.x));
    const int y = static_cast<int>(std::lround(start.corner_px.y));
    const int h = start.half_window;
    const double first = std::hypot(start.along_first.x, start.along_first.y);
    const double second = std::hypot(start.along_second.x, start.along_second.y);
    const double clear_area = start.clear_squares * std::abs(cross(start.along_first, start.along_second));
    std::vector<Pixel> pixels;
    for (int j = std::max(y - h, 0); j <= std::min(y + h, plane.rows - 1); ++j) {
        for (int i = std::max(x - h, 0); i <= std::min(x + h, plane.cols - 1); ++i) {
            const Vec2d offset{i - start.corner_px.x, j - start.corner_px.y};
            const double from_first = cross(start.along_first, offset) / first;
            const double from_second = cross(start.along_second, offset) / second;
            const bool is_far = std::abs(from_first) > clear_area / first - mask.guard_px &&
                                std::abs(from_second) > clear_area / second - mask.guard_px;
            if (!is_far || from_first * from_second * mask.white < 0.0) {
                pixels.push_back({static_cast<double>(i), static_cast<double>(j), plane.at<float>(j, i)});
            }
        }
    }
    return pixels;
}

/// The sum of squared differences from the mean.
double variance_of(const std::vector<Pixel>& pixels) {
    double sum = 0.0;
    double squares = 0.0;
    for (const Pixel& pixel : pixels) {
        sum += pixel.light;
        squares += pixel.light * pixel.light;
    }
    return squares - sum * sum / static_cast<double>(pixels.size());
}

/// Sets level and contrast to what explains the window best, the rest of `p` given.
void start_light(const std::vector<Pixel>& pixels, const LineWidths& widths, Parameters& p) {
    p[kLevel] = 0.0;
    p[kContrast] = 1.0;
    double sum = 0.0;
    double model_sum = 0.0;
    double model_squares = 0.0;
    double products = 0.0;
    Parameters unused;
    for (const Pixel& pixel : pixels) {
        const double model = residual({pixel.x, pixel.y, 0.0}, p, widths, unused);
        sum += pixel.light;
        model_sum += model;
        model_squares += model * model;
        products += model * pixel.light;
    }
    const auto count = static_cast<double>(pixels.size());
    const double spread = model_squares - model_sum * model_sum / count;
    p[kContrast] = spread > 0.0 ? (products - sum * model_sum / count) / spread : 0.0;
    p[kLevel] = (sum - p[kContrast] * model_sum) / count;
}

/// Least squares from `p`; whether it settled.
bool descend(const std::vector<Pixel>& pixels, const LineWidths& widths, int free_count, double largest_blur,
             Parameters& p, double& squares) {
    NormalSums sums = sums_at(pixels, p, widths);
    double damping = 1e-3;
    for (int step = 0; step < kMostCornerSteps; ++step) {
        Normal damped = sums.normal;
        damped.diagonal() *= 1.0 + damping;
        Parameters change = Parameters::Zero();
        change.head(free_count) =
            damped.topLeftCorner(free_count, free_count).ldlt().solve(sums.right.head(free_count));
        Parameters next = p + change;
        next[kBlur] = std::clamp(next[kBlur], kSmallestBlur_px, largest_blur);
        const NormalSums tried = next.allFinite() ? sums_at(pixels, next, widths) : NormalSums{.squares = sums.squares};
        const bool is_small = change.head(kAngle1).norm() < 1e-6;
        if (tried.squares < sums.squares) {
            p = next;
            sums = tried;
            damping = std::max(0.1 * damping, 1e-9);
        } else {
            damping *= 10.0;
        }
        squares = sums.squares;
        if (is_small || damping > 1e9) {
            return true;
        }
    }
    return false;
}

/// Standard errors of the corner's place, given the fit; see the header.
Vec2d standard_errors(const std::vector<Pixel>& pixels, const LineWidths& widths, int free_count, const Parameters& p,
                      double plane_blur_px) {
    const int reach = static_cast<int>(std::ceil(kBlurReach * plane_blur_px));
    int left = std::numeric_limits<int>::max();
    int top = left;
    int right = 0;
    int bottom = 0;
    for (const Pixel& pixel : pixels) {
        left = std::min(left, static_cast<int>(pixel.x));
        right = std::max(right, static_cast<int>(pixel.x));
        top = std::min(top, static_cast<int>(pixel.y));
        bottom = std::max(bottom, static_cast<int>(pixel.y));
    }
    const cv::Size size(right - left + 1 + 2 * reach, bottom - top + 1 + 2 * reach);
    std::vector<cv::Mat> slopes(static_cast<std::size_t>(free_count));
    for (cv::Mat& slope : slopes) {
        slope = cv::Mat::zeros(size, CV_64F);
    }
    Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(free_count, free_count);
    Parameters gradient;
    for (const Pixel& pixel : pixels) {
        residual(pixel, p, widths, gradient);
        const auto own = gradient.head(free_count);
        normal += own * own.transpose();
        for (int k = 0; k < free_count; ++k) {
            slopes[static_cast<std::size_t>(k)].at<double>(static_cast<int>(pixel.y) - top + reach,
                                                           static_cast<int>(pixel.x) - left + reach) = gradient[k];
        }
    }
    Eigen::MatrixXd blurred(size.area(), free_count);
    for (int k = 0; k < free_count; ++k) {
        cv::Mat& slope = slopes[static_cast<std::size_t>(k)];
        cv::GaussianBlur(slope, slope, {2 * reach + 1, 2 * reach + 1}, plane_blur_px, plane_blur_px,
                         cv::BORDER_CONSTANT);
        blurred.col(k) = Eigen::Map<const Eigen::VectorXd>(slope.ptr<double>(), size.area());
    }
    const Eigen::MatrixXd inverse = solve_symmetric(normal, Eigen::MatrixXd::Identity(free_count, free_count));
    const Eigen::MatrixXd meat = blurred.transpose() * blurred;
    const Eigen::MatrixXd covariance = inverse * meat * inverse;
    return {std::sqrt(std::max(covariance(kX, kX), 0.0)), std::sqrt(std::max(covariance(kY, kY), 0.0))};
}

}  // namespace

std::optional<CornerFit> fit_corner(const cv::Mat& plane, double plane_blur_px, const CornerStart& start) {
    const bool has_markers = std::isfinite(start.clear_squares);
    const int free_count =
        start.half_window < kCurvedFrom_px ? static_cast<int>(kCurvature1) : static_cast<int>(kCount);
    const double area = std::abs(cross(start.along_first, start.along_second));
    const LineWidths widths{start.line_squares * area / std::hypot(start.along_first.x, start.along_first.y),
                            start.line_squares * area / std::hypot(start.along_second.x, start.along_second.y)};
    // The markers' rims are black and stand alike around a corner: what blur carries across evens out, so that a guard
    // need not take all that is left of the white.
    const double clear_px = start.clear_squares * area /
                            std::max(std::hypot(start.along_first.x, start.along_first.y),
                                     std::hypot(start.along_second.x, start.along_second.y));
    CornerStart window = start;
    MarkerMask mask{.guard_px = kFirstGuard_px};
    Parameters p = Parameters::Zero();
    p[kX] = start.corner_px.x;
    p[kY] = start.corner_px.y;
    p[kAngle1] = std::atan2(start.along_first.y, start.along_first.x);
    p[kAngle2] = std::atan2(start.along_second.y, start.along_second.x);
    p[kBlur] = std::max(1.0, 0.15 * start.half_window);  // wide, so that a start a few pixels off still feels the edges
    bool settled = false;
    double unexplained = 1.0;
    std::vector<Pixel> pixels;
    // Where markers stand, what is white and how far blur carries their black is known once the corner is. Around
    // lines, whose widths are the lattice's and not exact, a window that is not even about the crossing would move it.
    for (int round = 0; round < (has_markers || start.line_squares > 0.0 ? 2 : 1); ++round) {
        pixels = pixels_of(plane, window, mask);
        if (pixels.size() < kFewestInWindow) {
            return std::nullopt;
        }
        double squares = 0.0;
        if (round == 0) {
            start_light(pixels, widths, p);
        }
        settled = descend(pixels, widths, free_count, start.half_window, p, squares);
        unexplained = squares / variance_of(pixels);
        window.corner_px = {p[kX], p[kY]};
        mask = {.guard_px = std::min(kGuardBlurs * p[kBlur], kMostGuard * clear_px), .white = p[kContrast]};
    }
    const double moved = std::hypot(p[kX] - start.corner_px.x, p[kY] - start.corner_px.y);
    if (!settled || !(moved <= std::max(1.5, 0.5 * start.half_window)) ||
        !(std::abs(p[kContrast]) > kLeastSlope * std::abs(p[kLevel])) || p[kBlur] > 0.5 * start.half_window ||
        !(unexplained < 1.0 - kLeastExplained)) {
        return std::nullopt;
    }
    return CornerFit{.corner_px = {p[kX], p[kY]},
                     .standard_error_px = standard_errors(pixels, widths, free_count, p, plane_blur_px)};
}

}  // namespace lensproof::calibration
