#include "calibration/explain/causes.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <optional>

#include "calibration/statistics/dense_solvers.h"
#include "engine/base/infinity.h"

namespace lensproof::calibration {

namespace {

std::string cause_name(const LensChange& change) {
    switch (change.kind) {
        case ChangeKind::focus:
            return "the focus";
        case ChangeKind::gap:
            return fmt::format("the gap behind surface {}", change.first);
        case ChangeKind::decentre:
            return fmt::format("surfaces {} to {} are decentred", change.first, change.last);
        case ChangeKind::tilt:
            return fmt::format("surfaces {} to {} are tilted", change.first, change.last);
        case ChangeKind::sensor_tilt:
            return "the sensor is tilted";
        case ChangeKind::n_d:
        case ChangeKind::V_d:
            return fmt::format("the glass behind surface {}", change.first);
        case ChangeKind::scale:
        case ChangeKind::sensor_shift:
            break;
    }
    return change.name;
}

double gap_mm(const optics::Lens& lens, int surface) {
    const auto i = static_cast<std::size_t>(surface);
    return lens.surfaces[i].vertex_z - lens.surfaces[i - 1].vertex_z;
}

/// Two spacers, each in the other's place.
void add_exchanges(const ExplainedLens& lens, const Belief& usual, std::vector<Cause>& causes) {
    const auto& changes = lens.changes;
    for (std::size_t i = 0; i < changes.size(); ++i) {
        for (std::size_t j = i + 1; j < changes.size(); ++j) {
            if (changes[i].kind != ChangeKind::gap || changes[j].kind != ChangeKind::gap) {
                continue;
            }
            const double more =
                gap_mm(lens.focused.front(), changes[j].first) - gap_mm(lens.focused.front(), changes[i].first);
            Cause cause{
                fmt::format("the gaps behind surfaces {} and {} are exchanged", changes[i].first, changes[j].first),
                {static_cast<int>(i), static_cast<int>(j)},
                usual};
            cause.belief.mean[static_cast<Eigen::Index>(i)] += more;
            cause.belief.mean[static_cast<Eigen::Index>(j)] -= more;
            if (std::abs(more) > 4.0 * tolerance(ChangeKind::gap).usual) {
                causes.push_back(std::move(cause));
            }
        }
    }
}

/// What the evidence of a belief would be, were residuals linear about a fit.
double linear_evidence(const LensFit& fit, const Belief& belief) {
    const Eigen::VectorXd& at = fit.state.changes;
    const Eigen::VectorXd usual = fit.belief.sigma.array().square().inverse();
    const Eigen::VectorXd precision = belief.sigma.array().square().inverse();
    const Eigen::VectorXd gradient = -usual.cwiseProduct(at - fit.belief.mean);  // of the data, where both balance
    Eigen::MatrixXd normal = fit.information;
    normal += precision.asDiagonal();
    const Eigen::VectorXd move = solve_symmetric(normal, -gradient - precision.cwiseProduct(at - belief.mean));
    const double chi2 = fit.chi2 + 2.0 * gradient.dot(move) + move.dot(fit.information * move);
    const double strain2 = precision.dot((at + move - belief.mean).cwiseAbs2());
    return -0.5 * (chi2 + strain2) + log_occam_factor(fit.information, belief.sigma);
}

std::vector<Cause> possible_causes(const ExplainedLens& lens) {
    const Belief usual = usual_belief(lens.changes);
    std::vector<Cause> causes;
    for (std::size_t i = 0; i < lens.changes.size(); ++i) {
        const double fault = tolerance(lens.changes[i].kind).fault;
        if (!(fault > 0.0)) {
            continue;
        }
        const std::string what = cause_name(lens.changes[i]);
        if (causes.empty() || causes.back().what != what || lens.changes[i].kind == ChangeKind::focus) {
            causes.push_back({what, {}, usual});
        }
        causes.back().changes.push_back(static_cast<int>(i));
        causes.back().belief.sigma[static_cast<Eigen::Index>(i)] = fault;
    }
    return causes;
}

/// The likeliest exchange: too far for a first order, so each is tried with all else as prescribed.
std::optional<Cause> likeliest_exchange(const ExplainedLens& lens, const SeenPoints& seen, const LensFit& usual) {
    std::vector<Cause> exchanges;
    add_exchanges(lens, usual_belief(lens.changes), exchanges);
    std::optional<Cause> best;
    double least = kInfinity;
    for (Cause& exchange : exchanges) {
        Belief belief = prescribed_belief(lens.changes);
        belief.mean = exchange.belief.mean;
        LensState start = start_of(lens, seen);
        start.poses = usual.state.poses;
        start.changes = belief.mean;
        const auto fit = fit_lens(lens, seen, start, belief);
        if (fit && fit->chi2 < least) {
            least = fit->chi2;
            best = std::move(exchange);
        }
    }
    return best;
}

}  // namespace

std::vector<FittedCause> likely_causes(const ExplainedLens& lens, const SeenPoints& seen, const LensFit& usual) {
    constexpr std::size_t kMostFitted = 4;
    constexpr double kWorthwhile = 3.0;
    constexpr double kFarBehind = 12.0;
    std::vector<std::pair<double, Cause>> promising;
    for (Cause& cause : possible_causes(lens)) {
        const double gain = linear_evidence(usual, cause.belief) - usual.log_evidence;
        if (gain > kWorthwhile) {
            promising.emplace_back(gain, std::move(cause));
        }
    }
    std::ranges::stable_sort(promising, std::greater<>(), &std::pair<double, Cause>::first);
    promising.resize(std::min(promising.size(), kMostFitted));
    std::erase_if(promising, [best = promising.empty() ? 0.0 : promising.front().first](const auto& of) {
        return of.first < best - kFarBehind;
    });
    constexpr double kStrained = 2.5;
    if (usual.largest_strain() > kStrained) {
        if (auto exchange = likeliest_exchange(lens, seen, usual)) {
            promising.emplace_back(0.0, std::move(*exchange));
        }
    }
    std::vector<FittedCause> likely;
    for (auto& [gain, cause] : promising) {
        LensState start = usual.state;
        if (!cause.belief.mean.isZero()) {
            start.changes = cause.belief.mean;
        }
        auto fit = fit_lens(lens, seen, start, cause.belief);
        if (fit && fit->log_evidence > usual.log_evidence) {
            likely.push_back({std::move(cause), std::move(*fit)});
        }
    }
    std::ranges::stable_sort(likely, std::greater<>(), [](const FittedCause& of) { return of.fit.log_evidence; });
    return likely;
}

}  // namespace lensproof::calibration
