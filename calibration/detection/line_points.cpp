#include "calibration/detection/line_points.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "calibration/detection/pixel_noise.h"

namespace lensproof::calibration {
namespace {

constexpr double kRamp_px = 2.0;           // over which a piece's ends fade, on either side
constexpr int kPieces = 3;                 // of a line between two crossings
constexpr double kCrossing = 0.2;          // of the distance between crossings, on either side, where the other line is
constexpr double kLineBlurReach_px = 4.0;  // beyond the line
constexpr double kPaper_px = 4.0;          // beyond that, for the ground
constexpr double kMostReach = 0.4;         // of a pitch, to either side
constexpr double kLeastDarkness = 0.2;     // of the light missing where the line is black
constexpr double kShortest_px = 12.0;
constexpr double kLargestOff_px = 2.0;
constexpr int kProfileRounds = 3;

// A piece of a line: along ± half_length of its middle; `inner` to either side is the line's, up to `outer` the paper.
struct Piece {
    Vec2d middle;
    Vec2d along;  // unit vector
    double half_length = 0.0;
    double inner = 0.0;
    double outer = 0.0;
    double width = 0.0;

    [[nodiscard]] Vec2d across() const { return {-along.y, along.x}; }
};

// Calls `visit(t, s, light)` for each pixel, t along and s across; false where one is missing or at full scale.
template <class Visit>
bool each(const formats::Image& image, int channel, const Piece& piece, const Visit& visit) {
    const Vec2d across = piece.across();
    const double reach_x = std::abs(piece.along.x) * (piece.half_length + kRamp_px) + std::abs(across.x) * piece.outer;
    const double reach_y = std::abs(piece.along.y) * (piece.half_length + kRamp_px) + std::abs(across.y) * piece.outer;
    const Vec2d& m = piece.middle;
    if (!(m.x - reach_x >= 0.0 && m.y - reach_y >= 0.0 && m.x + reach_x <= image.width - 1 &&
          m.y + reach_y <= image.height - 1)) {
        return false;
    }
    for (int y = static_cast<int>(std::ceil(m.y - reach_y)); y <= std::floor(m.y + reach_y); ++y) {
        for (int x = static_cast<int>(std::ceil(m.x - reach_x)); x <= std::floor(m.x + reach_x); ++x) {
            const double t = (x - m.x) * piece.along.x + (y - m.y) * piece.along.y;
            const double s = (x - m.x) * across.x + (y - m.y) * across.y;
            if (std::abs(t) > piece.half_length + kRamp_px || std::abs(s) > piece.outer) {
                continue;
            }
            const double light = image.at(x, y, channel);
            if (!std::isfinite(light) || light >= 1.0) {
                return false;
            }
            visit(t, s, light);
        }
    }
    return true;
}

// From 0 at -1 to 1 at 1, as a cosine.
double smooth_end(double inside) {
    return 0.5 * (1.0 + std::sin(0.5 * std::numbers::pi * std::clamp(inside, -1.0, 1.0)));
}

struct Across {
    double off = 0.0;             // from the piece's middle
    double standard_error = 0.0;  // for noise of standard deviation 1
};

std::optional<Across> centroid_across(const formats::Image& image, int channel, const Piece& piece) {
    using PlaneRow = Eigen::Vector3d;
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    PlaneRow right = PlaneRow::Zero();
    const bool is_seen = each(image, channel, piece, [&](double t, double s, double light) {
        if (std::abs(s) > piece.inner) {
            const PlaneRow row(1.0, t, s);
            normal += row * row.transpose();
            right += light * row;
        }
    });
    const Eigen::LDLT<Eigen::Matrix3d> solver(normal);
    if (!is_seen || normal(0, 0) < kShortest_px || !(solver.rcond() > 1e-9)) {
        return std::nullopt;
    }
    const PlaneRow paper = solver.solve(right);
    // The window ends softly, so that the pixels' grid does not show through.
    const auto fraction_at = [&](double t, double s) {
        return smooth_end((piece.half_length - std::abs(t)) / kRamp_px) * smooth_end(piece.inner - std::abs(s));
    };
    double mass = 0.0;
    double moment = 0.0;
    each(image, channel, piece, [&](double t, double s, double light) {
        const double missing = fraction_at(t, s) * (paper.dot(PlaneRow(1.0, t, s)) - light);
        mass += missing;
        moment += missing * s;
    });
    const double black = paper(0) * 2.0 * piece.half_length * piece.width;
    if (!(mass > kLeastDarkness * black)) {
        return std::nullopt;
    }
    Across result{.off = moment / mass};
    double squares = 0.0;
    PlaneRow by_paper = PlaneRow::Zero();
    each(image, channel, piece, [&](double t, double s, double /*light*/) {
        const double weight = fraction_at(t, s) * (s - result.off) / mass;
        squares += weight * weight;
        by_paper += weight * PlaneRow(1.0, t, s);
    });
    result.standard_error = std::sqrt(squares + by_paper.dot(solver.solve(by_paper)));
    return result;
}

// The line in the middle of a piece: the window follows it.
std::optional<LinePoint> point_on(const formats::Image& image, int channel, Piece piece) {
    std::optional<Across> found;
    double moved = 0.0;
    for (int round = 0; round < kProfileRounds; ++round) {
        found = centroid_across(image, channel, piece);
        if (!found) {
            return std::nullopt;
        }
        moved += found->off;
        piece.middle = {piece.middle.x + found->off * piece.across().x, piece.middle.y + found->off * piece.across().y};
        if (std::abs(moved) > kLargestOff_px) {
            return std::nullopt;
        }
    }
    return LinePoint{.image_px = piece.middle, .standard_error_px = found->standard_error};
}

}  // namespace

std::vector<LinePoints> line_points(const formats::Image& image, int channel, const ChartPoints& points,
                                    const scene::Chart& chart) {
    const auto* lines = std::get_if<scene::StraightLines>(&chart.pattern);
    if (lines == nullptr) {
        return {};
    }
    const double noise = pixel_noise(image, channel, points);
    std::vector<LinePoints> result;
    for (int i = 0; i < lines->columns + lines->rows; ++i) {
        const bool is_column = i < lines->columns;
        LinePoints line{.is_column = is_column, .index = is_column ? i : i - lines->columns, .points = {}};
        const int count = is_column ? lines->rows : lines->columns;
        const auto place = [&](int k) {
            return is_column ? static_cast<std::size_t>(k) * lines->columns + line.index
                             : static_cast<std::size_t>(line.index) * lines->columns + k;
        };
        const auto at = [&](int k) -> const Vec2d* {
            return k >= 0 && k < count && points.found[place(k)] ? &points.image_px[place(k)] : nullptr;
        };
        for (int k = 0; k + 1 < count; ++k) {
            const Vec2d* from = at(k);
            const Vec2d* to = at(k + 1);
            if (from == nullptr || to == nullptr) {
                continue;
            }
            const double length = std::hypot(to->x - from->x, to->y - from->y);
            // Perspective squeezes the pitch across the line otherwise than along it; half is safe.
            const double width = length * lines->line_mm / lines->pitch_mm;
            const double inner = 0.5 * width + kLineBlurReach_px;
            Piece piece{.middle = {},
                        .along = {(to->x - from->x) / length, (to->y - from->y) / length},
                        .half_length = 0.5 * (1.0 - 2.0 * kCrossing) / kPieces * length,
                        .inner = inner,
                        .outer = std::min(inner + kPaper_px, kMostReach * length),
                        .width = width};
            for (int j = 0; j < kPieces; ++j) {
                const double fraction = kCrossing + (1.0 - 2.0 * kCrossing) * (j + 0.5) / kPieces;
                piece.middle = {std::lerp(from->x, to->x, fraction), std::lerp(from->y, to->y, fraction)};
                if (const auto point = point_on(image, channel, piece)) {
                    line.points.push_back({point->image_px, noise * point->standard_error_px});
                }
            }
        }
        result.push_back(std::move(line));
    }
    return result;
}

}  // namespace lensproof::calibration
