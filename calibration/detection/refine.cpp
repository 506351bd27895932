#include "calibration/detection/refine.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "calibration/detection/corner_fit.h"
#include "calibration/detection/pixel_noise.h"
#include "calibration/detection/spot_centroid.h"
#include "calibration/detection/working_copy.h"
#include "engine/base/infinity.h"
#include "engine/base/input_error.h"

namespace lensproof::calibration {
namespace {

constexpr double kWindowFraction = 0.4;  // half window of the distance to the nearest corner
constexpr int kSmallestWindow_px = 2;    // half window: 5 × 5 pixels
constexpr int kLargestWindow_px = 14;    // half window; more pixels than noise asks for, and lines bend
constexpr int kFitFrom_px = 3;           // half window; in a smaller one the edge model has too few pixels to hold it
// Edges sharper than a pixel alias; this blur passes 3e-9 of what does. With 0.7 px (6e-5) a render at f/11 on coarse
// pixels gave a focal length that was 0.02 % too long with every seed (ClosedLoop, tessar).
constexpr double kBlur_px = 1.0;
constexpr double kSpotMargin_px = 3.0;
constexpr double kFrame_px = 2.5;       // closer to the frame, blurring has mirrored what is not there
constexpr double kAgreement_px = 0.05;  // of two searches from different starts
constexpr double kLeastContrast = 0.1;  // (white − black) / (white + black) around a corner

/// Whether every pixel within `reach` that the picture has is a number.
bool all_finite(const formats::Image& image, int channel, const Vec2d& at, double reach) {
    const int x0 = std::max(static_cast<int>(std::floor(at.x - reach)), 0);
    const int x1 = std::min(static_cast<int>(std::ceil(at.x + reach)), image.width - 1);
    const int y0 = std::max(static_cast<int>(std::floor(at.y - reach)), 0);
    const int y1 = std::min(static_cast<int>(std::ceil(at.y + reach)), image.height - 1);
    for (int y = y0; y <= y1; ++y) {
        for (int x = x0; x <= x1; ++x) {
            if (!std::isfinite(image.at(x, y, channel))) {
                return false;
            }
        }
    }
    return true;
}

bool is_inside(const formats::Image& image, const Vec2d& at, double margin) {
    return at.x >= margin && at.y >= margin && at.x <= image.width - 1 - margin && at.y <= image.height - 1 - margin;
}

bool is_near_frame(const formats::Image& image, const Vec2d& at) {
    return !is_inside(image, at, kFrame_px);
}

Vec2d difference(const Vec2d& a, const Vec2d& b) {
    return {a.x - b.x, a.y - b.y};
}
double norm(const Vec2d& v) {
    return std::hypot(v.x, v.y);
}

// The grid around a point: differences to its neighbours per step of a column and of a row, px.
struct Lattice {
    Vec2d column_step;
    Vec2d row_step;
    double nearest = kInfinity;
};

// None where no neighbour in the row, or none in the column, was found.
std::optional<Lattice> lattice_at(const ChartPoints& points, scene::GridSize grid, int column, int row) {
    const auto index = [&](int c, int r) { return static_cast<std::size_t>(r) * grid.columns + c; };
    const auto is_found = [&](int c, int r) {
        return c >= 0 && r >= 0 && c < grid.columns && r < grid.rows && points.found[index(c, r)];
    };
    const auto step = [&](int dc, int dr) -> std::optional<Vec2d> {
        const int before = is_found(column - dc, row - dr) ? 1 : 0;
        const int after = is_found(column + dc, row + dr) ? 1 : 0;
        if (before + after == 0) {
            return std::nullopt;
        }
        const Vec2d difference_px = difference(points.image_px[index(column + after * dc, row + after * dr)],
                                               points.image_px[index(column - before * dc, row - before * dr)]);
        return Vec2d{difference_px.x / (before + after), difference_px.y / (before + after)};
    };
    const auto column_step = step(1, 0);
    const auto row_step = step(0, 1);
    if (!column_step || !row_step) {
        return std::nullopt;
    }
    Lattice lattice{.column_step = *column_step, .row_step = *row_step};
    for (int r = row - 1; r <= row + 1; ++r) {
        for (int c = column - 1; c <= column + 1; ++c) {
            if ((c != column || r != row) && is_found(c, r)) {
                const Vec2d apart = difference(points.image_px[index(c, r)], points.image_px[index(column, row)]);
                lattice.nearest = std::min(lattice.nearest, norm(apart));
            }
        }
    }
    return lattice;
}

// (white − black) / (white + black) of the four squares that meet in a corner, sampled on their diagonals.
double corner_contrast(const cv::Mat& plane, const Vec2d& corner, const Lattice& lattice, double fraction) {
    double diagonal[2] = {0.0, 0.0};
    for (const int i : {-1, 1}) {
        for (const int j : {-1, 1}) {
            const double x = corner.x + fraction * (i * lattice.column_step.x + j * lattice.row_step.x);
            const double y = corner.y + fraction * (i * lattice.column_step.y + j * lattice.row_step.y);
            const int px = std::clamp(static_cast<int>(std::lround(x)), 0, plane.cols - 1);
            const int py = std::clamp(static_cast<int>(std::lround(y)), 0, plane.rows - 1);
            diagonal[i == j ? 0 : 1] += plane.at<float>(py, px);
        }
    }
    const double sum = diagonal[0] + diagonal[1];
    return sum > 0.0 ? std::abs(diagonal[0] - diagonal[1]) / sum : 0.0;
}

Vec2d corner_search(const cv::Mat& plane, const Vec2d& start, int half_window) {
    std::vector<cv::Point2f> point{{static_cast<float>(start.x), static_cast<float>(start.y)}};
    cv::cornerSubPix(plane, point, {half_window, half_window}, {-1, -1},
                     {cv::TermCriteria::EPS + cv::TermCriteria::COUNT, 60, 1e-4});
    return {point[0].x, point[0].y};
}

// A search in windows too small for a model: cv::cornerSubPix from two starts that must agree.
std::optional<Vec2d> search_corner(const cv::Mat& plane, const Vec2d& start, int half_window) {
    // cornerSubPix hands back its start when it runs away, so the second start must differ from the first's result.
    const Vec2d first = corner_search(plane, start, half_window);
    const double displacement = 0.25 * half_window;
    const Vec2d second = corner_search(plane, {first.x + displacement, first.y - 0.6 * displacement}, half_window);
    const bool agree = norm(difference(first, second)) <= kAgreement_px;
    return agree && norm(difference(second, start)) <= half_window ? std::optional(second) : std::nullopt;
}

struct RefinedPoint {
    Vec2d image_px;
    std::optional<Vec2d> standard_error_px;
};

std::optional<RefinedPoint> refine_corner(const formats::Image& image, const cv::Mat& plane, int channel,
                                          const Vec2d& start, const Lattice& lattice, const scene::PointLook& look) {
    const int half_window =
        std::clamp(static_cast<int>(kWindowFraction * lattice.nearest), kSmallestWindow_px, kLargestWindow_px);
    if (!all_finite(image, channel, start, half_window) || is_near_frame(image, start)) {
        return std::nullopt;
    }
    const auto* marked = std::get_if<scene::MarkedCorners>(&look);
    const auto* lines = std::get_if<scene::LineCrossings>(&look);
    const CornerStart corner_start{.corner_px = start,
                                   .along_first = lattice.column_step,
                                   .along_second = lattice.row_step,
                                   .half_window = half_window,
                                   .clear_squares = marked != nullptr ? marked->clear_squares : kInfinity,
                                   .line_squares = lines != nullptr ? lines->line_pitches : 0.0};
    std::optional<RefinedPoint> corner;
    if (half_window < kFitFrom_px) {
        if (const auto found = search_corner(plane, start, half_window)) {
            corner = {*found, std::nullopt};
        }
    } else if (const auto fitted = fit_corner(plane, kBlur_px, corner_start)) {
        corner = {fitted->corner_px, fitted->standard_error_px};
    }
    if (!corner || is_near_frame(image, corner->image_px) ||
        (lines == nullptr && corner_contrast(plane, corner->image_px, lattice,
                                             std::min(0.25, 0.7 * corner_start.clear_squares)) < kLeastContrast)) {
        return std::nullopt;
    }
    return corner;
}

std::optional<RefinedPoint> refine_spot(const formats::Image& image, int channel, const Vec2d& start,
                                        const Lattice& lattice, const scene::Spots& look) {
    const double radius = look.radius_pitches;
    const double determinant = lattice.column_step.x * lattice.row_step.y - lattice.column_step.y * lattice.row_step.x;
    // Far enough out for blur, and no farther: ground adds nothing but noise.
    const double step_px = std::min(norm(lattice.column_step), norm(lattice.row_step));
    const SpotWindow window{.x_unit_px = lattice.column_step,
                            .y_unit_px = lattice.row_step,
                            .inner = std::min(0.6 * radius + 0.4 * 0.5, radius + kSpotMargin_px / step_px),
                            .outer = look.is_bright ? std::max(0.5 - kSpotMargin_px / step_px, 0.4) : 0.5,
                            .area_px = std::numbers::pi * radius * radius * std::abs(determinant),
                            .least_fraction = kLeastContrast,
                            .is_bright = look.is_bright};
    const auto spot = std::abs(determinant) > 1.0 ? locate_spot(image, channel, start, window) : std::optional<Spot>();
    return spot ? std::optional(RefinedPoint{spot->centre_px, spot->standard_error_px}) : std::nullopt;
}

}  // namespace

ChartPoints refine(const formats::Image& image, int channel, const ChartPoints& approximate,
                   const scene::Chart& chart) {
    const scene::ChartTraits known = scene::traits(chart);
    const scene::GridSize grid = known.points;
    const auto expected = static_cast<std::size_t>(grid.columns) * grid.rows;
    if (approximate.image_px.size() != expected || approximate.found.size() != expected || grid.columns < 2 ||
        grid.rows < 2) {
        throw InputError("refining a " + scene::kind_name(chart) + ": " + std::to_string(approximate.image_px.size()) +
                         " points given, expected " + std::to_string(expected));
    }
    if (channel < 0 || channel >= image.channel_count()) {
        throw InputError("refining a " + scene::kind_name(chart) + ": the picture has no channel " +
                         std::to_string(channel));
    }
    const auto* spots = std::get_if<scene::Spots>(&known.look);
    cv::Mat plane;
    if (spots == nullptr) {
        // Edges sharper than a pixel are aliased, which biases search and fit alike; the blur takes that away.
        cv::GaussianBlur(channel_plane(image, channel), plane, {}, kBlur_px);
    }
    ChartPoints result{.image_px = approximate.image_px,
                       .found = std::vector<bool>(expected, false),
                       .standard_error_px = std::vector<std::optional<Vec2d>>(expected)};
    for (int row = 0; row < grid.rows; ++row) {
        for (int column = 0; column < grid.columns; ++column) {
            const std::size_t i = static_cast<std::size_t>(row) * grid.columns + column;
            const auto lattice =
                approximate.found[i] ? lattice_at(approximate, grid, column, row) : std::optional<Lattice>();
            if (!lattice) {
                continue;
            }
            const Vec2d& start = approximate.image_px[i];
            const auto refined = spots != nullptr ? refine_spot(image, channel, start, *lattice, *spots)
                                                  : refine_corner(image, plane, channel, start, *lattice, known.look);
            if (refined) {
                result.image_px[i] = refined->image_px;
                result.standard_error_px[i] = refined->standard_error_px;
                result.found[i] = true;
            }
        }
    }
    const double noise = pixel_noise(image, channel, result);
    for (std::optional<Vec2d>& error : result.standard_error_px) {
        if (error) {
            error = Vec2d{noise * error->x, noise * error->y};
        }
    }
    return result;
}

double disc_diameter_mm(const scene::Chart& chart) {
    const scene::PointLook look = scene::traits(chart).look;
    const auto* spots = std::get_if<scene::Spots>(&look);
    return spots != nullptr ? spots->moment_diameter_mm : 0.0;
}

int count_found(const ChartPoints& points) {
    return static_cast<int>(std::count(points.found.begin(), points.found.end(), true));
}

}  // namespace lensproof::calibration
