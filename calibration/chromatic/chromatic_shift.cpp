#include "calibration/chromatic/chromatic_shift.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <string>

#include "calibration/statistics/linear_fit.h"
#include "engine/base/input_error.h"

namespace lensproof::calibration {
namespace {

constexpr double kPairOutlierSigmas = 4.5;
constexpr double kLeastShiftSigma_px = 0.005;  // no detector is better
constexpr int kUnknowns = 7;
constexpr std::size_t kFewestPairs = 7;

// Σ term_i h^(2i+1) of the terms from `first` on, as far as `covered`.
Curve odd_curve(const std::vector<double>& terms, const ChromaticShift& shift, std::size_t first, double covered) {
    Curve curve;
    curve.covered_image_height = covered;
    for (const double h : standard_image_heights()) {
        if (h > covered) {
            break;
        }
        double value = 0.0;
        double variance = 0.0;
        for (std::size_t i = 0; i < terms.size(); ++i) {
            const double own = std::pow(h, static_cast<double>(2 * i + 1));
            value += own * terms[i];
            for (std::size_t j = 0; j < terms.size(); ++j) {
                variance += own * shift.covariance[(first + i) * kUnknowns + first + j] *
                            std::pow(h, static_cast<double>(2 * j + 1));
            }
        }
        const double half_width = k95 * std::sqrt(std::max(variance, 0.0));
        append(curve, h, {value, value - half_width, value + half_width});
    }
    return curve;
}

// A row for each direction in which a pair is known.
LinearProblem problem_of(const std::vector<ChromaticPair>& pairs,
                         const std::function<Vec2d(const ChromaticPair&)>& offset) {
    const auto rows = static_cast<Eigen::Index>(
        std::transform_reduce(pairs.begin(), pairs.end(), std::size_t{0}, std::plus<>(),
                              [](const ChromaticPair& pair) { return pair.normal ? std::size_t{1} : std::size_t{2}; }));
    LinearProblem problem{.a = Eigen::MatrixXd::Zero(rows, kUnknowns),
                          .y = Eigen::VectorXd(rows),
                          .row_sigma = Eigen::VectorXd::Ones(rows),
                          .group = {}};
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        const ChromaticPair& pair = pairs[i];
        const Vec2d q = offset(pair);
        const double rho2 = q.x * q.x + q.y * q.y;
        const Vec2d apart{pair.channel_px.x - pair.green_px.x, pair.channel_px.y - pair.green_px.y};
        const auto add = [&](const Vec2d& n) {
            const double radial = n.x * q.x + n.y * q.y;
            const double tangential = n.y * q.x - n.x * q.y;
            const auto row = static_cast<Eigen::Index>(problem.group.size());
            problem.a.row(row) << radial, radial * rho2, radial * rho2 * rho2, tangential, tangential * rho2, n.x, n.y;
            problem.y(row) = n.x * apart.x + n.y * apart.y;
            problem.group.push_back(static_cast<int>(i));
        };
        if (pair.normal) {
            add(*pair.normal);
        } else {
            add({1.0, 0.0});
            add({0.0, 1.0});
        }
    }
    return problem;
}

}  // namespace

ChromaticShift fit_chromatic_shift(const std::vector<ChromaticPair>& pairs, const Vec2d& centre_px,
                                   double half_diagonal_px) {
    if (!(half_diagonal_px > 0.0) || pairs.size() < kFewestPairs) {
        throw InputError("chromatic shift: " + std::to_string(pairs.size()) +
                         " points found in both channels: expected at least " + std::to_string(kFewestPairs));
    }
    const auto offset = [&](const ChromaticPair& pair) {
        return Vec2d{(pair.green_px.x - centre_px.x) / half_diagonal_px,
                     (pair.green_px.y - centre_px.y) / half_diagonal_px};
    };
    const LinearProblem problem = problem_of(pairs, offset);
    const auto fit = fit_linear(problem, kPairOutlierSigmas, kLeastShiftSigma_px);
    if (!fit) {
        throw InputError("chromatic shift: the " + std::to_string(pairs.size()) +
                         " points do not determine it: expected points at several distances from the centre");
    }
    ChromaticShift shift;
    std::copy_n(fit->parameters.begin(), 3, shift.radial_px.begin());
    std::copy_n(fit->parameters.begin() + 3, 2, shift.tangential_px.begin());
    shift.translation_px = {fit->parameters(5), fit->parameters(6)};
    std::copy_n(fit->covariance.data(), kUnknowns * kUnknowns, shift.covariance.begin());
    shift.rms_px = std::sqrt(fit->chi_squared / fit->rows_used);
    double covered = 0.0;
    for (std::size_t row = 0; row < problem.group.size(); ++row) {
        const auto i = static_cast<std::size_t>(problem.group[row]);
        if (fit->used[row] && (row == 0 || problem.group[row - 1] != problem.group[row])) {
            const Vec2d q = offset(pairs[i]);
            covered = std::max(covered, std::hypot(q.x, q.y));
            ++shift.pairs_used;
        }
    }
    shift.radial = odd_curve({shift.radial_px.begin(), shift.radial_px.end()}, shift, 0, covered);
    shift.tangential = odd_curve({shift.tangential_px.begin(), shift.tangential_px.end()}, shift, 3, covered);
    return shift;
}

}  // namespace lensproof::calibration
