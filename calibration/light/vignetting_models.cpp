#include "calibration/light/vignetting_models.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <optional>

#include "calibration/light/even_spline.h"
#include "calibration/statistics/linear_fit.h"
#include "calibration/statistics/smoothed_fit.h"

namespace lensproof::calibration {
namespace {

constexpr int kModelIterations = 30;
constexpr double kModelSettled = 1e-10;
constexpr int kBlockSide = 11;
constexpr int kPatchFolds = 5;
constexpr double kStep = 1e-6;  // of derivatives; parameters are of the order of one

// A formula: its parameters' names, and V at a place.
struct Formula {
    const char* name;
    std::vector<std::string> parameters;
    double (*ratio)(const std::vector<double>& p, const Vec2d& at);
};

double cos4(double k, double r2) {
    return 1.0 / ((1.0 + k * r2) * (1.0 + k * r2));
}

const std::vector<Formula>& formulas() {
    static const std::vector<Formula> list = {
        {"cos4",
         {"k"},
         [](const std::vector<double>& p, const Vec2d& at) { return cos4(p[0], at.x * at.x + at.y * at.y); }},
        {"pa",
         {"a1", "a2", "a3"},
         [](const std::vector<double>& p, const Vec2d& at) {
             const double r2 = at.x * at.x + at.y * at.y;
             return 1.0 + r2 * (p[0] + r2 * (p[1] + r2 * p[2]));
         }},
        {"kang-weiss", {"k", "alpha", "tilt_x", "tilt_y"}, [](const std::vector<double>& p, const Vec2d& at) {
             const double tilt = 1.0 + p[2] * at.x + p[3] * at.y;
             return (1.0 - p[1] * std::hypot(at.x, at.y)) * cos4(p[0], at.x * at.x + at.y * at.y) * tilt * tilt * tilt;
         }}};
    return list;
}

std::optional<double> log_ratio(const Formula& formula, const std::vector<double>& p, const Vec2d& at) {
    const double ratio = formula.ratio(p, at);
    return ratio > 0.0 ? std::optional(std::log(ratio)) : std::nullopt;
}

// The problem linearised about `p`: columns of the parameters, then of the gain; y is what is still missing.
std::optional<LinearProblem> linearised(const Formula& formula, const std::vector<double>& p,
                                        const std::vector<ShadingSample>& samples) {
    const auto count = static_cast<Eigen::Index>(samples.size());
    const auto unknowns = static_cast<Eigen::Index>(p.size());
    LinearProblem problem{.a = Eigen::MatrixXd(count, unknowns + 1),
                          .y = Eigen::VectorXd(count),
                          .row_sigma = Eigen::VectorXd(count),
                          .group = {}};
    problem.a.col(unknowns).setOnes();
    for (Eigen::Index i = 0; i < count; ++i) {
        const ShadingSample& sample = samples[static_cast<std::size_t>(i)];
        const auto here = log_ratio(formula, p, sample.at);
        if (!here) {
            return std::nullopt;
        }
        problem.y(i) = sample.log_ratio - *here;
        problem.row_sigma(i) = sample.sigma;
    }
    for (Eigen::Index k = 0; k < unknowns; ++k) {
        std::vector<double> moved = p;
        moved[static_cast<std::size_t>(k)] += kStep;
        for (Eigen::Index i = 0; i < count; ++i) {
            const ShadingSample& sample = samples[static_cast<std::size_t>(i)];
            const auto there = log_ratio(formula, moved, sample.at);
            if (!there) {
                return std::nullopt;
            }
            problem.a(i, k) = (*there - (sample.log_ratio - problem.y(i))) / kStep;
        }
    }
    return problem;
}

// A formula's parameters, and ln of the gain that the samples have against it.
struct FittedFormula {
    std::vector<double> parameters;
    LinearFit fit;
    double log_gain = 0.0;
};

std::optional<FittedFormula> fitted(const Formula& formula, const std::vector<ShadingSample>& samples) {
    std::vector<double> p(formula.parameters.size(), 0.0);
    std::optional<LinearFit> fit;
    for (int i = 0; i < kModelIterations; ++i) {
        const auto problem = linearised(formula, p, samples);
        fit = problem ? fit_linear(*problem, 0.0) : std::nullopt;
        if (!fit) {
            return std::nullopt;
        }
        double largest = 0.0;
        for (std::size_t k = 0; k < p.size(); ++k) {
            const double step = std::clamp(fit->parameters(static_cast<Eigen::Index>(k)), -0.5, 0.5);
            p[k] += step;
            largest = std::max(largest, std::abs(step));
        }
        if (largest < kModelSettled) {
            break;
        }
    }
    const double log_gain = fit->parameters(static_cast<Eigen::Index>(p.size()));
    return FittedFormula{std::move(p), std::move(*fit), log_gain};
}

VignettingModel model_of(const Formula& formula, const FittedFormula& found, const Vignetting& vignetting) {
    const auto count = static_cast<Eigen::Index>(formula.parameters.size());
    VignettingModel model{
        .name = formula.name,
        .parameter_names = formula.parameters,
        .values = found.parameters,
        .covariance = {},
        .relative_rms = std::sqrt(found.fit.residuals.squaredNorm() / found.fit.rows_used),
        .aicc = aicc(found.fit.chi_squared, found.fit.rows_used, static_cast<double>(count) + vignetting.gain_terms)};
    for (Eigen::Index i = 0; i < count; ++i) {
        for (Eigen::Index k = 0; k < count; ++k) {
            model.covariance.push_back(found.fit.covariance(i, k));
        }
    }
    return model;
}

// ln of the light that a model fitted to `samples` expects of a place.
using Prediction = std::function<double(const Vec2d& at)>;

std::optional<Prediction> formula_prediction(const Formula& formula, const std::vector<ShadingSample>& samples) {
    const auto found = fitted(formula, samples);
    if (!found) {
        return std::nullopt;
    }
    return [&formula, p = found->parameters, gain = found->log_gain](const Vec2d& at) {
        return gain + log_ratio(formula, p, at).value_or(-1.0);  // no light where there is some: far off
    };
}

std::optional<Prediction> spline_prediction(const EvenSpline& spline, const std::vector<ShadingSample>& samples) {
    const auto count = static_cast<Eigen::Index>(samples.size());
    LinearProblem problem{.a = Eigen::MatrixXd::Ones(count, spline.size() + 1),
                          .y = Eigen::VectorXd(count),
                          .row_sigma = Eigen::VectorXd(count),
                          .group = {}};
    for (Eigen::Index i = 0; i < count; ++i) {
        const ShadingSample& sample = samples[static_cast<std::size_t>(i)];
        problem.a.row(i).head(spline.size()) = spline.basis(std::hypot(sample.at.x, sample.at.y));
        problem.y(i) = sample.log_ratio;
        problem.row_sigma(i) = sample.sigma;
    }
    const auto fit = fit_smoothed(problem, spline.third_differences());
    if (!fit) {
        return std::nullopt;
    }
    return [spline, p = fit->parameters](const Vec2d& at) {
        return spline.basis(std::hypot(at.x, at.y)).dot(p.head(spline.size())) + p(spline.size());
    };
}

// The picture in blocks, each in one of five folds; blocks that touch along a side are in different folds.
struct Blocks {
    std::vector<int> block;  // of each sample
    std::vector<int> fold;   // of each block
};

Blocks blocks_of(const std::vector<ShadingSample>& samples) {
    Vec2d low = samples.front().pixel_px;
    Vec2d high = low;
    for (const ShadingSample& sample : samples) {
        low = {std::min(low.x, sample.pixel_px.x), std::min(low.y, sample.pixel_px.y)};
        high = {std::max(high.x, sample.pixel_px.x), std::max(high.y, sample.pixel_px.y)};
    }
    const auto index = [](double value, double least, double most) {
        const double fraction = most > least ? (value - least) / (most - least) : 0.0;
        return std::min(static_cast<int>(fraction * kBlockSide), kBlockSide - 1);
    };
    Blocks blocks;
    for (const ShadingSample& sample : samples) {
        blocks.block.push_back(index(sample.pixel_px.y, low.y, high.y) * kBlockSide +
                               index(sample.pixel_px.x, low.x, high.x));
    }
    for (int row = 0; row < kBlockSide; ++row) {
        for (int column = 0; column < kBlockSide; ++column) {
            blocks.fold.push_back((column + 2 * row) % kPatchFolds);
        }
    }
    return blocks;
}

// Squared errors of what was left out, in units of the samples' sigmas and summed by block; none where a model cannot
// be fitted to the rest.
using Fitter = std::function<std::optional<Prediction>(const std::vector<ShadingSample>& samples)>;

std::optional<std::vector<double>> held_out_squares(const Fitter& fit, const std::vector<ShadingSample>& samples,
                                                    const Blocks& blocks) {
    std::vector<double> squares(blocks.fold.size(), 0.0);
    for (int fold = 0; fold < kPatchFolds; ++fold) {
        const auto is_out = [&](std::size_t i) {
            return blocks.fold[static_cast<std::size_t>(blocks.block[i])] == fold;
        };
        std::vector<ShadingSample> rest;
        for (std::size_t i = 0; i < samples.size(); ++i) {
            if (!is_out(i)) {
                rest.push_back(samples[i]);
            }
        }
        const auto expected = fit(rest);
        if (!expected) {
            return std::nullopt;
        }
        for (std::size_t i = 0; i < samples.size(); ++i) {
            if (is_out(i)) {
                const double error = (samples[i].log_ratio - (*expected)(samples[i].at)) / samples[i].sigma;
                squares[static_cast<std::size_t>(blocks.block[i])] += error * error;
            }
        }
    }
    return squares;
}

struct CandidateModel {
    VignettingModel model;
    double terms = 0.0;
    std::vector<double> squares;
};

// How much more than `best` a candidate is off, in the sum of squares, less one standard error of the difference.
double excess(const CandidateModel& candidate, const CandidateModel& best, const Blocks& blocks) {
    std::vector<bool> is_lit(blocks.fold.size(), false);
    for (const int block : blocks.block) {
        is_lit[static_cast<std::size_t>(block)] = true;
    }
    const auto n = static_cast<double>(std::count(is_lit.begin(), is_lit.end(), true));
    double sum = 0.0;
    for (std::size_t b = 0; b < is_lit.size(); ++b) {
        sum += candidate.squares[b] - best.squares[b];
    }
    double squares = 0.0;
    for (std::size_t b = 0; b < is_lit.size(); ++b) {
        squares += is_lit[b] ? std::pow(candidate.squares[b] - best.squares[b] - sum / n, 2) : 0.0;
    }
    return sum - (n > 1.0 ? std::sqrt(squares * n / (n - 1.0)) : 0.0);
}

std::string percent(double ratio) {
    return fmt::format("{:.3f} %", 100.0 * ratio);
}

// The simplest of those that predict as well as the best within chance comes first (Breiman et al. 1984, 3.4.3), then
// by what they predict; and each is told why.
void choose(std::vector<CandidateModel>& candidates, const Blocks& blocks) {
    const auto held_out = [](const CandidateModel& c) { return c.model.held_out_relative_rms; };
    std::stable_sort(candidates.begin(), candidates.end(),
                     [&](const CandidateModel& a, const CandidateModel& b) { return held_out(a) < held_out(b); });
    const CandidateModel best = candidates.front();
    std::size_t chosen = 0;
    for (std::size_t i = 1; i < candidates.size(); ++i) {
        if (excess(candidates[i], best, blocks) <= 0.0 && candidates[i].terms < candidates[chosen].terms) {
            chosen = i;
        }
    }
    for (std::size_t i = 0; i < candidates.size(); ++i) {
        VignettingModel& model = candidates[i].model;
        const std::string own =
            fmt::format("predicts blocks that it has not seen to {}", percent(held_out(candidates[i])));
        const double much = held_out(candidates[i]) / held_out(best) - 1.0;
        if (i == chosen) {
            model.verdict =
                "chosen: " + own +
                (i == 0 ? ", better than any other"
                        : fmt::format(", like {} ({}) within chance, with fewer terms ({:.2g} against {:.2g})",
                                      best.model.name, percent(held_out(best)), candidates[i].terms, best.terms));
        } else if (excess(candidates[i], best, blocks) > 0.0) {
            model.verdict = own + fmt::format(", {:.1f} % worse than {}, beyond chance", 100.0 * much, best.model.name);
        } else {
            model.verdict =
                own + fmt::format(", no better than {} beyond chance, with more terms ({:.2g} against {:.2g})",
                                  candidates[chosen].model.name, candidates[i].terms, candidates[chosen].terms);
        }
    }
    std::rotate(candidates.begin(), candidates.begin() + static_cast<std::ptrdiff_t>(chosen),
                candidates.begin() + static_cast<std::ptrdiff_t>(chosen) + 1);
}

}  // namespace

double relative_illumination(const VignettingModel& model, const Vec2d& at) {
    const auto found = std::find_if(formulas().begin(), formulas().end(),
                                    [&](const Formula& formula) { return formula.name == model.name; });
    return found != formulas().end() ? found->ratio(model.values, at) : 1.0;
}

std::vector<VignettingModel> fit_vignetting_models(const Vignetting& vignetting) {
    const std::vector<ShadingSample>& samples = vignetting.samples;
    const Blocks blocks = blocks_of(samples);
    double weights = 0.0;
    for (const ShadingSample& sample : samples) {
        weights += 1.0 / (sample.sigma * sample.sigma);
    }
    std::vector<CandidateModel> candidates;
    const auto add = [&](VignettingModel model, double terms, const Fitter& fit) {
        auto squares = held_out_squares(fit, samples, blocks);
        if (squares) {
            const double sum = std::accumulate(squares->begin(), squares->end(), 0.0);
            model.held_out_relative_rms = std::sqrt(sum / weights);
            candidates.push_back({std::move(model), terms, std::move(*squares)});
        }
    };
    for (const Formula& formula : formulas()) {
        if (const auto found = fitted(formula, samples)) {
            add(model_of(formula, *found, vignetting), static_cast<double>(formula.parameters.size()),
                [&](const std::vector<ShadingSample>& rest) { return formula_prediction(formula, rest); });
        }
    }
    VignettingModel free_form{.name = "spline",
                              .parameter_names = {},
                              .values = {},
                              .covariance = {},
                              .relative_rms = vignetting.relative_rms,
                              .aicc = aicc(vignetting.chi_squared, vignetting.samples_used,
                                           vignetting.effective_terms + vignetting.gain_terms)};
    const EvenSpline spline{vignetting.spans, vignetting.ratio.covered_image_height};
    add(std::move(free_form), vignetting.effective_terms,
        [&](const std::vector<ShadingSample>& rest) { return spline_prediction(spline, rest); });
    if (!candidates.empty()) {
        choose(candidates, blocks);
    }
    std::vector<VignettingModel> models;
    models.reserve(candidates.size());
    for (CandidateModel& candidate : candidates) {
        models.push_back(std::move(candidate.model));
    }
    return models;
}

ShadingGrid shading_grid(const Vignetting& vignetting, int width_px, int height_px) {
    ShadingGrid grid;
    struct Sums {
        double count = 0.0, mean = 0.0, squares = 0.0, sigma = 0.0;
    };
    std::array<Sums, std::tuple_size_v<decltype(grid.cells)>> sums;
    const auto index = [](double pixel, int size) {
        return std::clamp(static_cast<int>((pixel + 0.5) / size * ShadingGrid::kSide), 0, ShadingGrid::kSide - 1);
    };
    for (const ShadingSample& sample : vignetting.samples) {
        const int cell = index(sample.pixel_px.y, height_px) * ShadingGrid::kSide + index(sample.pixel_px.x, width_px);
        Sums& own = sums.at(static_cast<std::size_t>(cell));  // Welford's recurrence
        const double value = std::exp(sample.log_ratio);
        own.count += 1.0;
        const double from_old = value - own.mean;
        own.mean += from_old / own.count;
        own.squares += from_old * (value - own.mean);
        own.sigma = sample.sigma * value;
    }
    for (std::size_t i = 0; i < sums.size(); ++i) {
        const Sums& own = sums.at(i);
        const double error = own.count > 1.0 ? std::sqrt(own.squares / (own.count - 1.0) / own.count) : own.sigma;
        grid.cells.at(i) = {own.mean, error, static_cast<int>(own.count)};
    }
    return grid;
}

}  // namespace lensproof::calibration
