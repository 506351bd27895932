#include "calibration/lines/line_distortion.h"

#include <ceres/jet.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "calibration/lines/line_consensus.h"
#include "calibration/statistics/student.h"
#include "engine/base/input_error.h"
#include "engine/base/order_statistics.h"

namespace lensproof::calibration {
namespace {

using Eigen::Index;

constexpr double kLeastPointSigma_px = 0.02;  // of a point: what repeats along an edge is not scatter
constexpr double kTolerance_px = 0.3;         // of a straight line's points, where noise is less,
constexpr double kTolerancePart = 3e-4;       // or of half the diagonal
constexpr double kStraightFraction = 0.5;     // of the lines' length, which a lens has to straighten
constexpr double kFisheyeGain = 1.02;         // of the straight length, by which a fisheye's law has to do better
constexpr double kLeastCosine = 0.02;         // tan θ has no value at 90°
constexpr int kFewestTerms = 2;               // of a lens's shape
constexpr int kParts = 4;                     // of the frame, along each side
constexpr int kFewestParts = 5;
constexpr double kWidest_percent = 3.0;  // half the 95 % interval where the lines end
constexpr std::size_t kReachingLines = 3;
constexpr double kFarthestCentre = 0.15;  // half diagonals; lenses' are nearer
constexpr double kTold = 0.5;  // of the prior's error, which what the lines tell of the centre has to be within

struct LineFrame {
    Vec2d middle;
    double half_diagonal = 1.0;
};

std::vector<PlumbLine> in_half_diagonals(const std::vector<SceneLine>& lines, const LineFrame& frame) {
    std::vector<PlumbLine> result;
    for (const SceneLine& line : lines) {
        PlumbLine& own = result.emplace_back();
        own.sigma = std::hypot(line.noise_px, kLeastPointSigma_px) / frame.half_diagonal;
        for (const Vec2d& p : line.points_px) {
            own.points.push_back((p - frame.middle) / frame.half_diagonal);
        }
    }
    return result;
}

double tolerance_of(const std::vector<SceneLine>& lines, const LineFrame& frame) {
    std::vector<double> noise;
    noise.reserve(lines.size());
    for (const SceneLine& line : lines) {
        noise.push_back(line.noise_px);
    }
    return std::max({2.0 * median(noise), kTolerance_px, kTolerancePart * frame.half_diagonal}) / frame.half_diagonal;
}

void check_spread(const std::vector<SceneLine>& lines, int width_px, int height_px) {
    std::array<bool, std::size_t{kParts} * kParts> seen{};
    const auto part = [](double at, int size) {
        return std::clamp(static_cast<int>(kParts * (at + 0.5) / size), 0, kParts - 1);
    };
    for (const SceneLine& line : lines) {
        for (const Vec2d& p : line.points_px) {
            const int at = kParts * part(p.y, height_px) + part(p.x, width_px);
            seen[static_cast<std::size_t>(at)] = seen[static_cast<std::size_t>(at)] || line.used;
        }
    }
    if (const auto count = std::ranges::count(seen, true); count < kFewestParts) {
        throw InputError(fmt::format(
            "the straight lines all lie in {} of the frame's {} parts, expected lines in at least {}: take them into "
            "the rest of the frame, or add pictures",
            count, kParts * kParts, kFewestParts));
    }
}

using ShapeJet = ceres::Jet<double, kShapeTerms>;

// Percent, with its slopes by the shape's terms.
ShapeJet distortion_at(const PlumbModel& model, double height) {
    if (height == 0.0) {
        return ShapeJet(0.0);
    }
    std::array<ShapeJet, kShapeTerms> shape;
    for (std::size_t k = 0; k < kShapeTerms; ++k) {
        shape[k] = ShapeJet(model.shape[k], static_cast<int>(k));
    }
    const auto ray = plumb_ray(model.kind, shape.data(), ShapeJet(height * height));
    const ShapeJet slope = model.kind == PlumbKind::fisheye ? shape[0] : ShapeJet(1.0);
    return 100.0 * (slope * ray.z / ray.s - 1.0);
}

// Where r(θ) ends: the undistorted radius, or the angle, no longer grows.
bool still_grows(const PlumbModel& model, double height) {
    const double t = height * height;
    const auto& k = model.shape;
    return model.kind == PlumbKind::perspective ? 1.0 + t * (3.0 * k[0] + t * (5.0 * k[1] + 7.0 * t * k[2])) > 0.0
                                                : 1.0 + t * (3.0 * k[1] + 5.0 * t * k[2]) > 0.0;
}

// `wider`: the same lens with one more term.
Curve curve_of(const PlumbFit& fit, const std::optional<PlumbFit>& wider, double covered) {
    Curve curve;
    curve.covered_image_height = covered;
    for (const double height : standard_image_heights()) {
        const ShapeJet value = distortion_at(fit.model, height);
        const PlumbRay<double> ray = plumb_ray(fit.model.kind, fit.model.shape.data(), height * height);
        if (!still_grows(fit.model, height) || !(ray.z > kLeastCosine)) {
            break;
        }
        Eigen::VectorXd gradient = Eigen::VectorXd::Zero(fit.model.terms + 2);
        gradient.head(fit.model.terms) = value.v.head(fit.model.terms);
        const double error = std::sqrt(std::max(gradient.dot(fit.covariance * gradient), 0.0));
        const double by_fit = error > 0.0 ? student_95(freedom_of(fit, gradient)) * error : 0.0;
        const double by_model = wider ? distortion_at(wider->model, height).a - value.a : 0.0;
        const double half = std::hypot(by_fit, k95 * by_model);
        append(curve, height, {value.a, value.a - half, value.a + half});
    }
    return curve;
}

// The farthest that so many lines reach from the centre.
double covered_height(const std::vector<PlumbLine>& lines, const std::vector<bool>& used, const Vec2d& centre) {
    std::vector<double> reach;
    for (std::size_t i = 0; i < lines.size(); ++i) {
        double farthest = 0.0;
        for (const Vec2d& p : lines[i].points) {
            const Vec2d q = p - centre;
            farthest = std::max(farthest, std::hypot(q.x, q.y));
        }
        if (used[i]) {
            reach.push_back(farthest);
        }
    }
    std::ranges::sort(reach, std::greater<>());
    return std::min(1.0, reach[std::min(kReachingLines, reach.size()) - 1]);
}

double held_out_of(const PlumbFit& fit) {
    double sum = 0.0;
    for (const double line : fit.held_out) {
        sum += line;
    }
    return sum / static_cast<double>(fit.held_out.size());
}

struct TermsChosen {
    PlumbFit fit;
    std::optional<PlumbFit> wider;
};

// Two terms or three, of the same lines, as predict lines that were not fitted best. One alone is a lens's shape too
// seldom: it wins by its bias where lines are noisy, and its bounds do not know of that.
std::optional<TermsChosen> choose_terms(const std::vector<PlumbLine>& lines, const PlumbModel& start) {
    std::vector<std::optional<PlumbFit>> fits;
    PlumbModel model = start;
    for (int terms = kFewestTerms; terms <= static_cast<int>(kShapeTerms); ++terms) {
        model.terms = terms;
        PlumbModel from = model;
        for (auto k = static_cast<std::size_t>(terms); k < kShapeTerms; ++k) {
            from.shape[k] = 0.0;
        }
        fits.push_back(fit_plumb_lines(lines, from));
    }
    std::optional<std::size_t> best;
    for (std::size_t i = 0; i < fits.size(); ++i) {
        if (fits[i] && (!best || held_out_of(*fits[i]) < held_out_of(*fits[*best]))) {
            best = i;
        }
    }
    if (!best) {
        return std::nullopt;
    }
    return TermsChosen{.fit = *fits[*best], .wider = *best + 1 < fits.size() ? fits[*best + 1] : std::nullopt};
}

std::optional<LineConsensus> best_consensus(const std::vector<PlumbLine>& lines, double tolerance) {
    auto straight = line_consensus(lines, PlumbKind::perspective, kFewestTerms, tolerance, kFewestLines);
    auto fisheye = line_consensus(lines, PlumbKind::fisheye, kFewestTerms, tolerance, kFewestLines);
    const bool is_fisheye =
        fisheye && (!straight || fisheye->straight_length > kFisheyeGain * straight->straight_length);
    return is_fisheye ? std::move(fisheye) : std::move(straight);
}

InputError no_lens(std::size_t found) {
    return InputError{
        fmt::format("of {} long edges no {} are straightened by one lens that straightens most of the others: expected "
                    "pictures in which most of the long edges are straight in the world",
                    found, kFewestLines)};
}

void add_terms(LineDistortion& result, const PlumbFit& fit, const LineFrame& frame) {
    const bool is_fisheye = fit.model.kind == PlumbKind::fisheye;
    for (int k = 0; k < fit.model.terms; ++k) {
        result.names.push_back(!is_fisheye ? fmt::format("k{}", k + 1) : k == 0 ? "phi" : fmt::format("b{}", k));
        result.values.push_back(fit.model.shape[static_cast<std::size_t>(k)]);
    }
    result.names.insert(result.names.end(), {"centre_x_px", "centre_y_px"});
    result.centre_px = frame.middle + frame.half_diagonal * fit.model.centre;
    result.values.insert(result.values.end(), {result.centre_px.x, result.centre_px.y});
    const Index count = fit.covariance.rows();
    const auto unit = [&](Index i) { return i < fit.model.terms ? 1.0 : frame.half_diagonal; };
    for (Index i = 0; i < count; ++i) {
        for (Index j = 0; j < count; ++j) {
            result.covariance.push_back(fit.covariance(i, j) * unit(i) * unit(j));
        }
    }
    const double most = kTold * kTold * kCentrePrior * kCentrePrior;
    result.centre_is_told = fit.covariance(count - 2, count - 2) < most && fit.covariance(count - 1, count - 1) < most;
}

void account_for(std::vector<SceneLine>& lines, const std::vector<PlumbLine>& scaled, const std::vector<bool>& used,
                 const PlumbModel& model, const LineFrame& frame, LineDistortion& result) {
    double squares = 0.0;
    double freedom = 0.0;
    for (std::size_t i = 0; i < lines.size(); ++i) {
        const Straightness own = straightened(model, scaled[i]);
        SceneLine& line = lines[i];
        line.used = used[i];
        line.rms_px = frame.half_diagonal * own.rms;
        line.bow_px = frame.half_diagonal * own.bow;
        line.residual_px.clear();
        for (const double e : own.residual) {
            line.residual_px.push_back(frame.half_diagonal * e);
        }
        if (used[i]) {
            const double own_freedom = static_cast<double>(line.points_px.size()) - 2.0;
            squares += own_freedom * line.rms_px * line.rms_px;
            freedom += own_freedom;
        }
    }
    result.used = static_cast<int>(std::ranges::count(used, true));
    result.left_out = static_cast<int>(lines.size()) - result.used;
    result.rms_px = std::sqrt(squares / freedom);
}

// A page that is not flat bends lines too, seldom about the picture's middle.
void check_centre(const LineDistortion& result, const LineFrame& frame) {
    const double off = length(result.centre_px - frame.middle);
    if (off > kFarthestCentre * frame.half_diagonal) {
        throw InputError(fmt::format(
            "the long edges bend about a centre {:.0f} px off the picture's middle, expected at most {:.0f}: whole "
            "pictures, not parts of them, in which most of the long edges are straight in the world",
            off, kFarthestCentre * frame.half_diagonal));
    }
}

void check_tells(const LineDistortion& result) {
    // None where the lens that was found folds back before: lines that tell hold it from that.
    const auto end = sample(result.distortion, result.covered_image_height);
    const double half = end ? 0.5 * (end->upper_95 - end->lower_95) : 0.0;
    if (!end || !(half < kWidest_percent)) {
        throw InputError(fmt::format(
            "the {} straight lines do not tell the distortion: at image height {:.2f} it would be {}; lines through "
            "the middle do not bend, expected more straight lines that pass it by, along the frame's sides",
            result.used, result.covered_image_height,
            end ? fmt::format("{:.1f} ± {:.1f} %", end->value, half) : "anything"));
    }
}

}  // namespace

LineDistortion fit_line_distortion(std::vector<SceneLine>& lines, int width_px, int height_px) {
    if (static_cast<int>(lines.size()) < kFewestLines) {
        throw InputError(
            fmt::format("{} long edges found, expected at least {} that are straight in the world, each at least a "
                        "tenth of the diagonal long",
                        lines.size(), kFewestLines));
    }
    const LineFrame frame{.middle = {0.5 * (width_px - 1), 0.5 * (height_px - 1)},
                          .half_diagonal = 0.5 * std::hypot(width_px, height_px)};
    const std::vector<PlumbLine> scaled = in_half_diagonals(lines, frame);
    const auto consensus = best_consensus(scaled, tolerance_of(lines, frame));
    if (!consensus) {
        throw no_lens(lines.size());
    }
    const auto chosen = choose_terms(those_used(scaled, consensus->used), consensus->fit.model);
    if (!chosen) {
        throw no_lens(lines.size());
    }
    LineDistortion result;
    result.kind = chosen->fit.model.kind;
    account_for(lines, scaled, consensus->used, chosen->fit.model, frame, result);
    double straight = 0.0;
    double all = 0.0;
    for (const SceneLine& line : lines) {
        straight += line.used ? chord_px(line) : 0.0;
        all += chord_px(line);
    }
    if (straight < kStraightFraction * all) {
        throw InputError(fmt::format(
            "the lens that straightens most of {} long edges leaves {:.0f} % of their length bent: expected pictures "
            "in which most of the long edges are straight in the world, and a lens that is round about its axis",
            lines.size(), 100.0 * (1.0 - straight / all)));
    }
    check_spread(lines, width_px, height_px);
    add_terms(result, chosen->fit, frame);
    result.covered_image_height = covered_height(scaled, consensus->used, chosen->fit.model.centre);
    result.distortion = curve_of(chosen->fit, chosen->wider, result.covered_image_height);
    const std::vector<double>& heights = result.distortion.image_height;
    if (still_grows(chosen->fit.model, heights.back() + heights[1])) {  // it ends at 90°, where lines go on
        result.covered_image_height = std::min(result.covered_image_height, heights.back());
    }
    check_centre(result, frame);
    check_tells(result);
    return result;
}

}  // namespace lensproof::calibration
