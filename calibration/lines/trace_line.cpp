#include "calibration/lines/trace_line.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>

#include "calibration/lines/edge_place.h"
#include "calibration/statistics/linear_fit.h"

namespace lensproof::calibration {
namespace {

constexpr double kLeastSpacing_px = 3.0;
constexpr double kMostPlaces = 120.0;
constexpr double kReach_px = 6.0;
constexpr double kLeastSeenFraction = 0.33;  // of the places, which show the edge: half of a chessboard's do
constexpr std::size_t kFewestLinePoints = 15;
constexpr int kCurveDegree = 5;  // of the curve across the chord
constexpr double kOffCurveSigmas = 4.0;
constexpr double kLeastScatter_px = 0.005;

// Points in the frame of a chord: along it from -1 to 1, and across, px.
struct ChordFrame {
    Vec2d middle;
    Vec2d along;
    double half_px = 0.0;

    [[nodiscard]] Vec2d across() const { return {along.y, -along.x}; }
    [[nodiscard]] Vec2d place(double t, double d) const { return middle + (t * half_px) * along + d * across(); }
    [[nodiscard]] double along_of(const Vec2d& p) const {
        return ((p.x - middle.x) * along.x + (p.y - middle.y) * along.y) / half_px;
    }
    [[nodiscard]] double across_of(const Vec2d& p) const {
        return (p.x - middle.x) * along.y - (p.y - middle.y) * along.x;
    }
};

ChordFrame frame_of(const Vec2d& from, const Vec2d& to) {
    const LineSegment chord{from, to};
    return {0.5 * (from + to), direction_of(chord), 0.5 * length_of(chord)};
}

struct SmoothCurve {
    ChordFrame frame;
    Eigen::VectorXd coefficients;  // of Legendre's polynomials
    double scatter_px = 0.0;
    std::vector<bool> used;
};

std::array<double, kCurveDegree + 1> legendre(double t) {
    std::array<double, kCurveDegree + 1> p{1.0, t};
    for (int k = 1; k < kCurveDegree; ++k) {
        p[k + 1] = ((2 * k + 1) * t * p[k] - k * p[k - 1]) / (k + 1);
    }
    return p;
}

std::optional<SmoothCurve> smooth_curve(const std::vector<Vec2d>& points) {
    if (points.size() < kFewestLinePoints) {
        return std::nullopt;
    }
    SmoothCurve curve{.frame = frame_of(points.front(), points.back()), .coefficients = {}, .used = {}};
    const auto rows = static_cast<Eigen::Index>(points.size());
    LinearProblem problem{.a = Eigen::MatrixXd(rows, kCurveDegree + 1),
                          .y = Eigen::VectorXd(rows),
                          .row_sigma = Eigen::VectorXd::Ones(rows),
                          .group = {}};
    for (Eigen::Index i = 0; i < rows; ++i) {
        const Vec2d& p = points[static_cast<std::size_t>(i)];
        const auto basis = legendre(curve.frame.along_of(p));
        for (Eigen::Index k = 0; k <= kCurveDegree; ++k) {
            problem.a(i, k) = basis[static_cast<std::size_t>(k)];
        }
        problem.y(i) = curve.frame.across_of(p);
    }
    auto fit = fit_linear(problem, kOffCurveSigmas, kLeastScatter_px);
    if (!fit) {
        return std::nullopt;
    }
    curve.coefficients = fit->parameters;
    curve.scatter_px = fit->scale;
    curve.used = std::move(fit->used);
    return curve;
}

Vec2d place_on(const SmoothCurve& curve, double t) {
    const auto basis = legendre(t);
    double d = 0.0;
    for (Eigen::Index k = 0; k <= kCurveDegree; ++k) {
        d += curve.coefficients(k) * basis[static_cast<std::size_t>(k)];
    }
    return curve.frame.place(t, d);
}

// Corners of the chain's way: the ends of its segments.
std::vector<Vec2d> corners_of(const LineChain& chain) {
    std::vector<Vec2d> corners;
    for (const LineSegment& segment : chain) {
        // Segments that overlap would turn the way back.
        if (corners.size() > 1) {
            const Vec2d on = segment.from - corners.back();
            const Vec2d u = direction_of(segment);
            if (on.x * u.x + on.y * u.y <= 0.0) {
                corners.pop_back();
                corners.push_back(segment.to);
                continue;
            }
        }
        corners.push_back(segment.from);
        corners.push_back(segment.to);
    }
    return corners;
}

std::vector<EdgePiece> pieces_along(const std::vector<Vec2d>& places, double spacing, double reach) {
    std::vector<EdgePiece> pieces;
    double next = 0.5 * spacing;  // along the corner's leg
    for (std::size_t i = 1; i < places.size(); ++i) {
        const LineSegment leg{places[i - 1], places[i]};
        const double length = length_of(leg);
        if (!(length > 0.0)) {
            continue;
        }
        const Vec2d u = direction_of(leg);
        for (; next < length; next += spacing) {
            pieces.push_back({leg.from + next * u, u, 0.5 * spacing, reach});
        }
        next -= length;
    }
    return pieces;
}

// Where the pieces show the edge.
std::vector<Vec2d> places_at(const cv::Mat& plane, const std::vector<EdgePiece>& pieces) {
    std::vector<Vec2d> points;
    for (const EdgePiece& piece : pieces) {
        if (const auto place = edge_place(plane, piece)) {
            points.push_back(piece.centre_px + place->across_px * Vec2d{piece.along.y, -piece.along.x});
        }
    }
    return points;
}

}  // namespace

std::optional<SceneLine> trace_line(const cv::Mat& plane, const LineChain& chain, double scale) {
    const double spacing = std::max(kLeastSpacing_px, chord_of(chain) / kMostPlaces);
    const auto rough =
        smooth_curve(places_at(plane, pieces_along(corners_of(chain), spacing, kReach_px + 2.0 * (scale - 1.0))));
    if (!rough) {
        return std::nullopt;
    }
    std::vector<Vec2d> places;
    const int steps = std::max(8, static_cast<int>(2.0 * rough->frame.half_px / spacing));
    for (int i = 0; i <= steps; ++i) {
        places.push_back(place_on(*rough, -1.0 + 2.0 * i / steps));
    }
    const std::vector<EdgePiece> pieces = pieces_along(places, spacing, kReach_px);
    const std::vector<Vec2d> points = places_at(plane, pieces);
    const auto fine = smooth_curve(points);
    if (!fine || static_cast<double>(points.size()) < kLeastSeenFraction * static_cast<double>(pieces.size())) {
        return std::nullopt;
    }
    SceneLine line;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (fine->used[i]) {
            line.points_px.push_back(points[i]);
        }
    }
    line.noise_px = fine->scatter_px;
    return line.points_px.size() < kFewestLinePoints ? std::nullopt : std::optional(std::move(line));
}

}  // namespace lensproof::calibration
