#include "calibration/light/vignetting.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <optional>
#include <string>

#include "calibration/light/even_spline.h"
#include "calibration/statistics/linear_fit.h"
#include "calibration/statistics/smoothed_fit.h"
#include "engine/base/input_error.h"
#include "engine/base/order_statistics.h"

namespace lensproof::calibration {
namespace {

constexpr std::array<int, 9> kSpans = {1, 2, 3, 4, 6, 8, 12, 16, 24};
constexpr double kPatchOutlierSigmas = 5.0;
constexpr std::size_t kFewestSamples = 12;
constexpr std::size_t kPooled = 31;         // patches whose noise is taken to be the same
constexpr std::size_t kFewestPerGroup = 5;  // a group's own terms are three
constexpr int kSamplesPerParameter = 4;
constexpr double kLeastPatchError = 1e-3;  // dust, print and pixel response: no patch is evener than that
constexpr double kLeastScale = 2.0;        // of that: within 1 % nothing is an outlier
constexpr double kGradientUnit_mm = 100.0;

struct PatchRow {
    Vec2d pixel_px;
    Vec2d at;  // from the centre, in half-diagonals
    double r = 0.0;
    double log_value = 0.0;
    double sigma = 0.0;
    Vec2d chart;  // in units of kGradientUnit_mm
    int group = 0;
    bool on_chart = false;
};

// A patch of 49 pixels tells its own noise to a tenth, and weights that scatter so cost 4 % of variance that no
// covariance knows of. Patches as bright as each other have the same noise: the median over the nearest in brightness.
void pool_errors(std::vector<LightSample>& samples) {
    std::stable_sort(samples.begin(), samples.end(),
                     [](const LightSample& a, const LightSample& b) { return a.value < b.value; });
    const std::size_t window = std::min(kPooled, samples.size());
    std::vector<double> pooled;
    pooled.reserve(samples.size());
    for (std::size_t i = 0; i < samples.size(); ++i) {
        const std::size_t first = std::min(i > window / 2 ? i - window / 2 : 0, samples.size() - window);
        std::vector<double> errors;
        errors.reserve(window);
        for (std::size_t k = first; k < first + window; ++k) {
            errors.push_back(samples[k].relative_error);
        }
        pooled.push_back(median(errors));
    }
    for (std::size_t i = 0; i < samples.size(); ++i) {
        samples[i].relative_error = pooled[i];
    }
}

std::vector<PatchRow> rows_of(const std::vector<LightGroup>& groups, const Vec2d& centre, double half_diagonal) {
    std::vector<PatchRow> rows;
    int index = 0;
    for (const LightGroup& group : groups) {
        std::vector<LightSample> lit;
        std::copy_if(group.samples.begin(), group.samples.end(), std::back_inserter(lit), [](const LightSample& s) {
            return std::isfinite(s.value) && s.value > 0.0 && std::isfinite(s.relative_error);
        });
        if (lit.size() < kFewestPerGroup) {
            continue;
        }
        pool_errors(lit);
        std::vector<PatchRow> own;
        own.reserve(lit.size());
        for (const LightSample& s : lit) {
            const Vec2d at{(s.pixel_px.x - centre.x) / half_diagonal, (s.pixel_px.y - centre.y) / half_diagonal};
            own.push_back({.pixel_px = s.pixel_px,
                           .at = at,
                           .r = std::hypot(at.x, at.y),
                           .log_value = std::log(s.value),
                           .sigma = std::hypot(s.relative_error, kLeastPatchError),
                           .chart = {s.chart_mm.x / kGradientUnit_mm, s.chart_mm.y / kGradientUnit_mm},
                           .group = index,
                           .on_chart = group.on_chart});
        }
        rows.insert(rows.end(), own.begin(), own.end());
        ++index;
    }
    return rows;
}

// Columns: the spline's coefficients, then a gain for every group, then two gradients for every chart.
LinearProblem linear_problem(const std::vector<PatchRow>& rows, const EvenSpline& spline) {
    std::vector<int> first_column;
    int columns = spline.size();
    for (const PatchRow& row : rows) {
        if (row.group == static_cast<int>(first_column.size())) {
            first_column.push_back(columns);
            columns += row.on_chart ? 3 : 1;
        }
    }
    const auto count = static_cast<Eigen::Index>(rows.size());
    LinearProblem problem{.a = Eigen::MatrixXd::Zero(count, columns),
                          .y = Eigen::VectorXd(count),
                          .row_sigma = Eigen::VectorXd(count),
                          .group = {}};
    for (Eigen::Index i = 0; i < count; ++i) {
        const PatchRow& row = rows[static_cast<std::size_t>(i)];
        const int own = first_column[static_cast<std::size_t>(row.group)];
        problem.a.row(i).head(spline.size()) = spline.basis(row.r);
        problem.a(i, own) = 1.0;
        if (row.on_chart) {
            problem.a(i, own + 1) = row.chart.x;
            problem.a(i, own + 2) = row.chart.y;
        }
        problem.y(i) = row.log_value;
        problem.row_sigma(i) = row.sigma;
    }
    return problem;
}

// As many spans as the samples determine, by plain least squares: what outliers are judged by.
struct Richest {
    EvenSpline spline;
    LinearFit fit;
};

std::optional<Richest> richest(const std::vector<PatchRow>& rows, double reach) {
    for (auto spans = kSpans.rbegin(); spans != kSpans.rend(); ++spans) {
        const EvenSpline spline{*spans, reach};
        const LinearProblem problem = linear_problem(rows, spline);
        if (problem.a.cols() * kSamplesPerParameter > problem.a.rows() && *spans != kSpans.front()) {
            continue;
        }
        if (auto fit = fit_linear(problem, kPatchOutlierSigmas, kLeastScale)) {
            return Richest{spline, std::move(*fit)};
        }
    }
    return std::nullopt;
}

// Without outliers, and with errors that charts and flat fields show themselves.
std::vector<PatchRow> cleaned(const std::vector<PatchRow>& rows, const LinearFit& fit) {
    double squares[2] = {0.0, 0.0};
    int count[2] = {0, 0};
    for (std::size_t i = 0; i < rows.size(); ++i) {
        if (fit.used[i]) {
            const double normalized = fit.residuals(static_cast<Eigen::Index>(i)) / rows[i].sigma;
            squares[rows[i].on_chart ? 1 : 0] += normalized * normalized;
            ++count[rows[i].on_chart ? 1 : 0];
        }
    }
    std::vector<PatchRow> result;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        if (fit.used[i]) {
            const int kind = rows[i].on_chart ? 1 : 0;
            result.push_back(rows[i]);
            if (squares[kind] > 0.0 && squares[1 - kind] > 0.0) {  // one kind alone: a common factor changes nothing
                result.back().sigma *= std::sqrt(squares[kind] / count[kind]);
            }
        }
    }
    return result;
}

// Groups whose samples all went are closed up, so that no column is empty.
void renumber(std::vector<PatchRow>& rows) {
    int next = -1;
    int last = -1;
    for (PatchRow& row : rows) {
        if (row.group != last) {
            last = row.group;
            ++next;
        }
        row.group = next;
    }
}

Vignetting sampled(const EvenSpline& spline, const SmoothedFit& fit, const std::vector<PatchRow>& rows,
                   double covered) {
    Vignetting result;
    result.spans = spline.spans;
    result.samples_used = static_cast<int>(rows.size());
    result.chi_squared = fit.chi_squared;
    result.gain_terms = static_cast<int>(fit.parameters.size()) - spline.size();
    result.effective_terms = fit.effective_parameters - result.gain_terms;
    result.samples.reserve(rows.size());
    for (std::size_t i = 0; i < rows.size(); ++i) {  // the spline plus what it leaves: gains and gradients are out
        const double on_curve = spline.basis(rows[i].r).dot(fit.parameters.head(spline.size()));
        result.samples.push_back({.pixel_px = rows[i].pixel_px,
                                  .at = rows[i].at,
                                  .log_ratio = on_curve + fit.residuals(static_cast<Eigen::Index>(i)),
                                  .sigma = rows[i].sigma});
    }
    result.ratio.covered_image_height = result.ev.covered_image_height = covered;
    const int size = spline.size();
    for (const double h : standard_image_heights()) {
        if (h > covered) {
            break;
        }
        const Eigen::RowVectorXd phi = spline.basis(h);
        const double log_v = h > 0.0 ? phi.dot(fit.parameters.head(size)) : 0.0;
        const double variance = phi * fit.covariance * phi.transpose();
        const double half_width = k95 * std::sqrt(std::max(variance, 0.0));
        const Banded log_band{log_v, log_v - half_width, log_v + half_width};
        append(result.ratio, h, {std::exp(log_band.value), std::exp(log_band.lower_95), std::exp(log_band.upper_95)});
        append(result.ev, h,
               {log_band.value * std::numbers::log2e, log_band.lower_95 * std::numbers::log2e,
                log_band.upper_95 * std::numbers::log2e});
    }
    for (int i = 0; i < size; ++i) {
        result.coefficients.push_back(fit.parameters(i));
        for (int k = 0; k < size; ++k) {
            result.covariance.push_back(fit.covariance(i, k));
        }
    }
    result.relative_rms = std::sqrt(fit.residuals.squaredNorm() / static_cast<double>(rows.size()));
    return result;
}

}  // namespace

Vignetting fit_vignetting(const std::vector<LightGroup>& groups, const Vec2d& centre_px, double half_diagonal_px) {
    if (!(half_diagonal_px > 0.0) || !std::isfinite(centre_px.x + centre_px.y)) {
        throw InputError("vignetting: the picture has no size or no centre");
    }
    std::vector<PatchRow> rows = rows_of(groups, centre_px, half_diagonal_px);
    if (rows.size() < kFewestSamples) {
        throw InputError("vignetting: " + std::to_string(rows.size()) +
                         " lit patches of even tone: expected at least " + std::to_string(kFewestSamples));
    }
    const auto reach_of = [](const std::vector<PatchRow>& list) {
        return std::max_element(list.begin(), list.end(),
                                [](const PatchRow& a, const PatchRow& b) { return a.r < b.r; })
            ->r;
    };
    const auto fail = [&] {
        return InputError("vignetting: the " + std::to_string(rows.size()) +
                          " patches do not determine it: expected patches from the middle to the edge of the picture");
    };
    if (!(reach_of(rows) > 0.0)) {
        throw fail();
    }
    const auto first = richest(rows, reach_of(rows));
    if (!first) {
        throw fail();
    }
    rows = cleaned(rows, first->fit);
    renumber(rows);
    const double reach = reach_of(rows);
    const EvenSpline spline{first->spline.spans, reach};
    const auto fit = fit_smoothed(linear_problem(rows, spline), spline.third_differences());
    if (!fit) {
        throw fail();
    }
    return sampled(spline, *fit, rows, reach);
}

PolynomialVignetting polynomial_vignetting(const Curve& ratio) {
    const auto count = static_cast<Eigen::Index>(ratio.image_height.size());
    LinearProblem problem{.a = Eigen::MatrixXd(count, 3),
                          .y = Eigen::VectorXd(count),
                          .row_sigma = Eigen::VectorXd::Ones(count),
                          .group = {}};
    for (Eigen::Index i = 0; i < count; ++i) {
        const double r2 = std::pow(ratio.image_height[static_cast<std::size_t>(i)], 2);
        problem.a.row(i) << r2, r2 * r2, r2 * r2 * r2;
        problem.y(i) = ratio.value[static_cast<std::size_t>(i)] - 1.0;
    }
    const auto fit = fit_linear(problem, 0.0);
    if (!fit) {
        throw InputError("vignetting: a curve of " + std::to_string(count) +
                         " samples cannot be fitted by three terms");
    }
    PolynomialVignetting result;
    std::copy_n(fit->parameters.begin(), 3, result.a.begin());
    result.largest_error = fit->residuals.cwiseAbs().maxCoeff();
    return result;
}

}  // namespace lensproof::calibration
