#include "calibration/light/vignetting_models.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "calibration/statistics/linear_fit.h"

namespace lensproof {
namespace {

constexpr int kIterations = 30;
constexpr double kSettled = 1e-10;
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
    for (Eigen::Index i = 0; i < count; ++i) {
        const ShadingSample& sample = samples[static_cast<std::size_t>(i)];
        const auto here = log_ratio(formula, p, sample.at);
        if (!here) {
            return std::nullopt;
        }
        problem.y(i) = sample.log_ratio - *here;
        problem.row_sigma(i) = sample.sigma;
        problem.a(i, unknowns) = 1.0;
        for (Eigen::Index k = 0; k < unknowns; ++k) {
            std::vector<double> moved = p;
            moved[static_cast<std::size_t>(k)] += kStep;
            const auto there = log_ratio(formula, moved, sample.at);
            if (!there) {
                return std::nullopt;
            }
            problem.a(i, k) = (*there - *here) / kStep;
        }
    }
    return problem;
}

std::optional<VignettingModel> fitted(const Formula& formula, const Vignetting& vignetting) {
    std::vector<double> p(formula.parameters.size(), 0.0);
    std::optional<LinearFit> fit;
    for (int i = 0; i < kIterations; ++i) {
        const auto problem = linearised(formula, p, vignetting.samples);
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
        if (largest < kSettled) {
            break;
        }
    }
    VignettingModel model{
        .name = formula.name,
        .parameter_names = formula.parameters,
        .values = p,
        .covariance = {},
        .relative_rms = std::sqrt(fit->residuals.squaredNorm() / fit->rows_used),
        .aicc = aicc(fit->chi_squared, fit->rows_used, static_cast<double>(p.size()) + vignetting.gain_terms)};
    for (Eigen::Index i = 0; i < static_cast<Eigen::Index>(p.size()); ++i) {
        for (Eigen::Index k = 0; k < static_cast<Eigen::Index>(p.size()); ++k) {
            model.covariance.push_back(fit->covariance(i, k));
        }
    }
    return model;
}

}  // namespace

double relative_illumination(const VignettingModel& model, const Vec2d& at) {
    const auto found = std::find_if(formulas().begin(), formulas().end(),
                                    [&](const Formula& formula) { return formula.name == model.name; });
    return found != formulas().end() ? found->ratio(model.values, at) : 1.0;
}

std::vector<VignettingModel> fit_vignetting_models(const Vignetting& vignetting) {
    std::vector<VignettingModel> models;
    for (const Formula& formula : formulas()) {
        if (auto model = fitted(formula, vignetting)) {
            models.push_back(std::move(*model));
        }
    }
    models.push_back({.name = "spline",
                      .parameter_names = {},
                      .values = {},
                      .covariance = {},
                      .relative_rms = vignetting.relative_rms,
                      .aicc = aicc(vignetting.chi_squared, vignetting.samples_used,
                                   static_cast<double>(vignetting.coefficients.size()) + vignetting.gain_terms)});
    std::stable_sort(models.begin(), models.end(),
                     [](const VignettingModel& a, const VignettingModel& b) { return a.aicc < b.aicc; });
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

}  // namespace lensproof
