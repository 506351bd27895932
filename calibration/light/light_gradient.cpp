#include "calibration/light/light_gradient.h"

#include <cmath>

#include "calibration/statistics/linear_fit.h"

namespace lensproof::calibration {

std::optional<Vec2d> light_gradient_per_mm(const LightGroup& white, const Curve& vignetting, const Vec2d& centre_px,
                                           double half_diagonal_px) {
    constexpr std::size_t kFewest = 6;
    constexpr double kOutlier = 5.0;
    std::vector<Vec2d> places;
    std::vector<double> logs;
    for (const LightSample& sample_of_white : white.samples) {
        const Vec2d from{sample_of_white.pixel_px.x - centre_px.x, sample_of_white.pixel_px.y - centre_px.y};
        const auto ratio = sample(vignetting, std::hypot(from.x, from.y) / half_diagonal_px);
        if (ratio && ratio->value > 0.0 && sample_of_white.value > 0.0) {
            places.push_back(sample_of_white.chart_mm);
            logs.push_back(std::log(sample_of_white.value / ratio->value));
        }
    }
    if (logs.size() < kFewest) {
        return std::nullopt;
    }
    const auto rows = static_cast<Eigen::Index>(logs.size());
    LinearProblem problem{.a = Eigen::MatrixXd(rows, 3),
                          .y = Eigen::VectorXd(rows),
                          .row_sigma = Eigen::VectorXd::Ones(rows),
                          .group = {}};
    for (Eigen::Index i = 0; i < rows; ++i) {
        const auto at = static_cast<std::size_t>(i);
        problem.a.row(i) << 1.0, places[at].x, places[at].y;
        problem.y[i] = logs[at];
    }
    const auto fit = fit_linear(problem, kOutlier, 1e-6);
    return fit ? std::optional(Vec2d{fit->parameters[1], fit->parameters[2]}) : std::nullopt;
}

}  // namespace lensproof::calibration
