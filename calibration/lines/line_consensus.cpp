#include "calibration/lines/line_consensus.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/base/order_statistics.h"

namespace lensproof::calibration {
namespace {

constexpr int kConsensusRounds = 12;
constexpr double kMostRms = 3.0;  // of the median,
constexpr double kMostBow = 5.0;
constexpr double kMostNoise = 4.0;  // of the bow that a line's own noise makes
constexpr double kLeastRms = 5e-5;  // half diagonals; what is straighter than that is straight
constexpr double kLeastBow = 2e-5;
constexpr double kStartRms = 4.0;  // of the tolerance, before anything but one term is fitted

// Corner distortions from 40 % pincushion to 50 % barrel; fisheyes whose corners are 15° to 130° from the axis.
std::vector<double> first_terms(PlumbKind kind) {
    const bool is_fisheye = kind == PlumbKind::fisheye;
    const double from = is_fisheye ? 0.26 : -0.3;
    const double to = is_fisheye ? 2.26 : 1.0;
    constexpr double kStep = 0.04;
    std::vector<double> terms;
    for (int i = 0; from + i * kStep <= to; ++i) {
        terms.push_back(from + i * kStep);
    }
    return terms;
}

double span_of(const PlumbLine& line) {
    const Vec2d span = line.points.back() - line.points.front();
    return std::hypot(span.x, span.y);
}

double counted(double rms, double tolerance) {
    return 1.0 / (1.0 + (rms / tolerance) * (rms / tolerance));
}

// Every so manieth point, the ends among them: enough to see a bend.
std::vector<PlumbLine> thinned(std::vector<PlumbLine> lines, std::size_t most) {
    for (PlumbLine& line : lines) {
        const std::size_t count = line.points.size();
        if (count > most) {
            for (std::size_t i = 0; i < most; ++i) {
                line.points[i] = line.points[i * (count - 1) / (most - 1)];
            }
            line.points.resize(most);
        }
    }
    return lines;
}

PlumbModel first_guess(const std::vector<PlumbLine>& all, PlumbKind kind, double tolerance) {
    constexpr std::size_t kLooked = 12;  // points of a line
    const std::vector<PlumbLine> lines = thinned(all, kLooked);
    PlumbModel best{.kind = kind};
    double most = -1.0;
    for (const double term : first_terms(kind)) {
        const PlumbModel tried{.kind = kind, .terms = 1, .shape = {term, 0.0, 0.0}, .centre = {}};
        if (const double length = straight_length(lines, tried, tolerance); length > most) {
            most = length;
            best = tried;
        }
    }
    return best;
}

// Which lines the model straightens, by what is usual among those that were used.
std::vector<bool> straight_lines(const std::vector<PlumbLine>& lines, const std::vector<bool>& before,
                                 const PlumbModel& model) {
    std::vector<Straightness> all;
    std::vector<double> rms;
    std::vector<double> bows;
    for (std::size_t i = 0; i < lines.size(); ++i) {
        all.push_back(straightened(model, lines[i]));
        if (before[i]) {
            rms.push_back(all.back().rms);
            bows.push_back(all.back().bow);
        }
    }
    const double most_rms = kMostRms * std::max(median(rms), kLeastRms);
    const double most_bow = kMostBow * std::max(median(bows), kLeastBow);
    std::vector<bool> used;
    for (std::size_t i = 0; i < lines.size(); ++i) {
        const double by_noise =
            kMostNoise * lines[i].sigma * std::sqrt(2.0 / static_cast<double>(all[i].residual.size()));
        used.push_back(all[i].rms <= most_rms && all[i].bow <= std::hypot(most_bow, by_noise));
    }
    return used;
}

}  // namespace

std::vector<PlumbLine> those_used(const std::vector<PlumbLine>& lines, const std::vector<bool>& used) {
    std::vector<PlumbLine> result;
    for (std::size_t i = 0; i < lines.size(); ++i) {
        if (used[i]) {
            result.push_back(lines[i]);
        }
    }
    return result;
}

double straight_length(const std::vector<PlumbLine>& lines, const PlumbModel& model, double tolerance) {
    double sum = 0.0;
    for (const PlumbLine& line : lines) {
        sum += span_of(line) * counted(straightened(model, line).rms, tolerance);
    }
    return sum;
}

std::optional<LineConsensus> line_consensus(const std::vector<PlumbLine>& all, PlumbKind kind, int terms,
                                            double tolerance, int fewest) {
    constexpr std::size_t kFitted = 30;  // points of a line, of which the consensus is made
    const std::vector<PlumbLine> lines = thinned(all, kFitted);
    PlumbModel model = first_guess(lines, kind, tolerance);
    std::vector<bool> used;
    used.reserve(lines.size());
    for (const PlumbLine& line : lines) {
        used.push_back(straightened(model, line).rms <= kStartRms * tolerance);
    }
    std::optional<PlumbFit> fit;
    for (int round = 0; round < kConsensusRounds; ++round) {
        if (std::ranges::count(used, true) < fewest) {
            return std::nullopt;
        }
        model.terms = std::min(terms, round + 1);
        fit = fit_plumb_lines(those_used(lines, used), model);
        if (!fit) {
            return std::nullopt;
        }
        model = fit->model;
        std::vector<bool> next = straight_lines(lines, used, model);
        if (next == used && model.terms == terms) {
            break;
        }
        used = std::move(next);
    }
    if (std::ranges::count(used, true) < fewest) {
        return std::nullopt;
    }
    fit = fit_plumb_lines(those_used(lines, used), model);
    if (!fit) {
        return std::nullopt;
    }
    const double length = straight_length(lines, fit->model, tolerance);
    return LineConsensus{.fit = std::move(*fit), .used = std::move(used), .straight_length = length};
}

}  // namespace lensproof::calibration
