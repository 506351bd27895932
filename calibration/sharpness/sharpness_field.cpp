#include "calibration/sharpness/sharpness_field.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>

#include "calibration/statistics/linear_fit.h"
#include "engine/base/angle.h"
#include "engine/base/input_error.h"

namespace lensproof::calibration {
namespace {

constexpr std::size_t kFewestEdges = 6;
constexpr int kMostPairs = 4;
constexpr double kOutlierSigmas = 5.0;
constexpr double kRowsPerParameter = 3.0;
constexpr double kLeastRelativeError = 0.005;  // of 1/MTF50²: prints are no better
constexpr double kLeastFractionOfBest = 1.0 / 3.0;
constexpr double kLeastVertexSigmas = 3.0;  // of the parabola's opening

// An edge as a row: image height, fraction of the tangential blur, and 1/MTF50² with its error.
struct BlurRow {
    double height = 0.0;
    double tangential = 0.0;  // cos² φ
    double value = 0.0;       // px²
    double sigma = 0.0;
    double position = 0.0;  // of the focus, mm
};

std::vector<BlurRow> blur_rows(const std::vector<EdgeMtf>& edges, const Vec2d& centre, double half_diagonal) {
    std::vector<BlurRow> rows;
    for (const EdgeMtf& edge : edges) {
        if (!edge.mtf50) {
            continue;
        }
        const double f = edge.mtf50->cycles_per_px;
        const double dx = edge.centre_px.x - centre.x;
        const double dy = edge.centre_px.y - centre.y;
        const double turn = radians(edge.normal_deg) - std::atan2(dy, dx);
        rows.push_back({.height = std::hypot(dx, dy) / half_diagonal,
                        .tangential = std::cos(turn) * std::cos(turn),
                        .value = 1.0 / (f * f),
                        .sigma = std::hypot(2.0 * edge.mtf50->standard_error / f, kLeastRelativeError) / (f * f)});
    }
    return rows;
}

// a, then t_j and s_j: an even polynomial of the height in each direction.
Eigen::RowVectorXd field_basis(double height, double tangential, int pairs) {
    Eigen::RowVectorXd basis(1 + 2 * pairs);
    basis(0) = 1.0;
    double power = 1.0;
    for (int j = 0; j < pairs; ++j) {
        power *= height * height;
        basis(1 + 2 * j) = power * tangential;
        basis(2 + 2 * j) = power * (1.0 - tangential);
    }
    return basis;
}

struct CandidateFit {
    int pairs = 0;
    LinearFit fit;
    std::vector<BlurRow> rows;  // that it rests on
};

// The fit with the number of pairs of terms that AICc prefers, outliers taken out by the richest one alone.
std::optional<CandidateFit> best_by_aicc(std::vector<BlurRow> rows,
                                         const std::function<Eigen::RowVectorXd(const BlurRow&, int)>& basis) {
    const auto fit_with = [&](int pairs, double outlier_sigmas) -> std::optional<LinearFit> {
        const auto count = static_cast<Eigen::Index>(rows.size());
        const Eigen::Index columns = basis(rows.front(), pairs).size();
        if (static_cast<double>(columns) * kRowsPerParameter > static_cast<double>(count) && pairs > 0) {
            return std::nullopt;
        }
        LinearProblem problem{.a = Eigen::MatrixXd(count, columns),
                              .y = Eigen::VectorXd(count),
                              .row_sigma = Eigen::VectorXd(count),
                              .group = {}};
        for (Eigen::Index i = 0; i < count; ++i) {
            const BlurRow& row = rows[static_cast<std::size_t>(i)];
            problem.a.row(i) = basis(row, pairs);
            problem.y(i) = row.value;
            problem.row_sigma(i) = row.sigma;
        }
        return fit_linear(problem, outlier_sigmas);
    };
    for (int pairs = kMostPairs; pairs >= 0; --pairs) {
        if (const auto richest = fit_with(pairs, kOutlierSigmas)) {
            std::vector<BlurRow> kept;
            for (std::size_t i = 0; i < rows.size(); ++i) {
                if (richest->used[i]) {
                    kept.push_back(rows[i]);
                }
            }
            rows = std::move(kept);
            break;
        }
    }
    std::optional<CandidateFit> best;
    double least = std::numeric_limits<double>::infinity();
    for (int pairs = 0; pairs <= kMostPairs; ++pairs) {
        auto fit = fit_with(pairs, 0.0);
        if (!fit) {
            continue;
        }
        const double criterion = aicc(fit->chi_squared, fit->rows_used, static_cast<double>(fit->parameters.size()));
        if (!best || criterion < least) {
            least = criterion;
            best = CandidateFit{.pairs = pairs, .fit = std::move(*fit), .rows = {}};
        }
    }
    if (best) {
        best->rows = std::move(rows);
    }
    return best;
}

double farthest(const std::vector<BlurRow>& rows) {
    double height = 0.0;
    for (const BlurRow& row : rows) {
        height = std::max(height, row.height);
    }
    return height;
}

// MTF50 = 1/√b with the band that b's has; none where the band reaches b = 0.
std::optional<Banded> mtf50_of(const Eigen::RowVectorXd& basis, const LinearFit& fit) {
    const double b = basis.dot(fit.parameters);
    const double half_width = k95 * std::sqrt(std::max((basis * fit.covariance * basis.transpose()).value(), 0.0));
    if (!(b - half_width > 0.0)) {
        return std::nullopt;
    }
    return Banded{1.0 / std::sqrt(b), 1.0 / std::sqrt(b + half_width), 1.0 / std::sqrt(b - half_width)};
}

// √(b_s / b_t) = tangential MTF50 over sagittal, by the delta method.
Banded ratio_of(const Eigen::RowVectorXd& tangential, const Eigen::RowVectorXd& sagittal, const LinearFit& fit) {
    const double t = tangential.dot(fit.parameters);
    const double s = sagittal.dot(fit.parameters);
    const double ratio = std::sqrt(s / t);
    const Eigen::RowVectorXd gradient = 0.5 * ratio * (sagittal / s - tangential / t);
    const double half_width =
        k95 * std::sqrt(std::max((gradient * fit.covariance * gradient.transpose()).value(), 0.0));
    return {ratio, ratio - half_width, ratio + half_width};
}

}  // namespace

SharpnessField fit_sharpness_field(const std::vector<EdgeMtf>& edges, const Vec2d& centre_px, double half_diagonal_px) {
    const std::vector<BlurRow> rows = blur_rows(edges, centre_px, half_diagonal_px);
    if (rows.size() < kFewestEdges) {
        throw InputError("sharpness: " + std::to_string(rows.size()) + " edges with an MTF50: expected at least " +
                         std::to_string(kFewestEdges) + " for a curve over the picture");
    }
    const auto best = best_by_aicc(
        rows, [](const BlurRow& row, int pairs) { return field_basis(row.height, row.tangential, pairs); });
    if (!best) {
        throw InputError("sharpness: the " + std::to_string(rows.size()) + " edges do not determine a curve");
    }
    const LinearFit& fit = best->fit;
    SharpnessField field;
    field.edges_used = fit.rows_used;
    const double covered = farthest(best->rows);
    for (Curve* curve :
         {&field.tangential_cycles_per_px, &field.sagittal_cycles_per_px, &field.tangential_over_sagittal}) {
        curve->covered_image_height = covered;
    }
    for (const double h : standard_image_heights()) {
        const Eigen::RowVectorXd t = field_basis(h, 1.0, best->pairs);
        const Eigen::RowVectorXd s = field_basis(h, 0.0, best->pairs);
        const auto tangential = mtf50_of(t, fit);
        const auto sagittal = mtf50_of(s, fit);
        if (h > covered || !tangential || !sagittal) {
            break;
        }
        append(field.tangential_cycles_per_px, h, *tangential);
        append(field.sagittal_cycles_per_px, h, *sagittal);
        append(field.tangential_over_sagittal, h, ratio_of(t, s, fit));
    }
    for (Eigen::Index i = 0; i < fit.parameters.size(); ++i) {
        field.names.push_back(i == 0 ? "a" : (i % 2 == 1 ? "t" : "s") + std::to_string((i + 1) / 2));
        field.coefficients.push_back(fit.parameters(i));
        for (Eigen::Index k = 0; k < fit.parameters.size(); ++k) {
            field.covariance.push_back(fit.covariance(i, k));
        }
    }
    double squares = 0.0;  // of MTF50's relative residual: half that of 1/MTF50²
    for (std::size_t i = 0; i < best->rows.size(); ++i) {
        squares += 0.25 * std::pow(fit.residuals(static_cast<Eigen::Index>(i)) / best->rows[i].value, 2);
    }
    field.relative_rms = std::sqrt(squares / fit.rows_used);
    return field;
}

namespace {

// Columns: the field's basis times 1, z and z².
Eigen::RowVectorXd focus_basis(const Eigen::RowVectorXd& field, double z) {
    Eigen::RowVectorXd basis(3 * field.size());
    basis << field, z * field, z * z * field;
    return basis;
}

// A vertex −c1/(2 c2) and its gradient; none without an opening.
struct Vertex {
    double z = 0.0;
    Eigen::RowVectorXd gradient;
};

std::optional<Vertex> vertex(const Eigen::RowVectorXd& field, const LinearFit& fit) {
    const Eigen::Index n = field.size();
    const double c1 = field.dot(fit.parameters.segment(n, n));
    const double c2 = field.dot(fit.parameters.segment(2 * n, n));
    const double c2_error =
        std::sqrt(std::max((field * fit.covariance.block(2 * n, 2 * n, n, n) * field.transpose()).value(), 0.0));
    if (!(c2 > kLeastVertexSigmas * c2_error)) {
        return std::nullopt;
    }
    Vertex result{.z = -c1 / (2.0 * c2), .gradient = Eigen::RowVectorXd::Zero(3 * n)};
    result.gradient.segment(n, n) = -field / (2.0 * c2);
    result.gradient.segment(2 * n, n) = field * (c1 / (2.0 * c2 * c2));
    return result;
}

// Rows that are not far from the sharpest of their tenth of the height.
std::vector<BlurRow> near_focus(const std::vector<BlurRow>& rows) {
    std::array<double, 16> least{};
    least.fill(std::numeric_limits<double>::infinity());
    const auto band = [&](const BlurRow& row) {
        return std::min(least.size() - 1, static_cast<std::size_t>(row.height * 10.0));
    };
    for (const BlurRow& row : rows) {
        least[band(row)] = std::min(least[band(row)], row.value);
    }
    std::vector<BlurRow> kept;
    for (const BlurRow& row : rows) {
        if (row.value <= least[band(row)] / (kLeastFractionOfBest * kLeastFractionOfBest)) {
            kept.push_back(row);
        }
    }
    return kept;
}

}  // namespace

BestFocus fit_best_focus(const std::vector<FocusedEdges>& series, const Vec2d& centre_px, double half_diagonal_px) {
    std::vector<double> positions;
    std::vector<BlurRow> rows;
    for (const FocusedEdges& picture : series) {
        positions.push_back(picture.position_mm);
        for (BlurRow row : blur_rows(picture.edges, centre_px, half_diagonal_px)) {
            row.position = picture.position_mm;
            rows.push_back(row);
        }
    }
    std::sort(positions.begin(), positions.end());
    if (std::unique(positions.begin(), positions.end()) - positions.begin() < 3) {
        throw InputError("field curvature: the pictures have fewer than three focus positions: expected at least 3");
    }
    rows = near_focus(rows);
    if (rows.size() < 3 * kFewestEdges) {
        throw InputError("field curvature: " + std::to_string(rows.size()) + " edges near focus: expected at least " +
                         std::to_string(3 * kFewestEdges));
    }
    const double middle = 0.5 * (positions.front() + positions.back());
    const double unit = 0.5 * (positions.back() - positions.front());  // keeps the powers of z alike in size
    const auto best = best_by_aicc(rows, [&](const BlurRow& row, int pairs) {
        return focus_basis(field_basis(row.height, row.tangential, pairs), (row.position - middle) / unit);
    });
    const auto on_axis = best ? vertex(field_basis(0.0, 1.0, best->pairs), best->fit) : std::nullopt;
    if (!on_axis || std::abs(on_axis->z) > 1.5) {
        throw InputError("field curvature: no best focus among the pictures' positions: expected some on either side");
    }
    const auto error = [&](const Eigen::RowVectorXd& gradient) {
        return unit * std::sqrt(std::max((gradient * best->fit.covariance * gradient.transpose()).value(), 0.0));
    };
    BestFocus result{.axis_position_mm = middle + unit * on_axis->z,
                     .axis_standard_error_mm = error(on_axis->gradient),
                     .tangential_mm = {},
                     .sagittal_mm = {},
                     .edges_used = best->fit.rows_used};
    for (const double tangential : {1.0, 0.0}) {
        Curve& curve = tangential > 0.0 ? result.tangential_mm : result.sagittal_mm;
        curve.covered_image_height = farthest(best->rows);
        for (const double h : standard_image_heights()) {
            const auto here = vertex(field_basis(h, tangential, best->pairs), best->fit);
            if (h > curve.covered_image_height || !here) {
                break;
            }
            const double value = unit * (here->z - on_axis->z);
            const double half_width = k95 * error(here->gradient - on_axis->gradient);
            append(curve, h, {value, value - half_width, value + half_width});
        }
    }
    return result;
}

}  // namespace lensproof::calibration
