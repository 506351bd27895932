#include "calibration/corner_fit.h"

#include <ceres/ceres.h>

#include <array>
#include <cmath>
#include <numbers>

namespace lensproof {
namespace {

constexpr int kCurvedFrom_px = 6;        // half window
constexpr double kFarthest_px = 1.5;     // the start is better than that
constexpr double kLeastContrast = 0.05;  // |b| of the window's mean light

enum Parameter {
    kX,
    kY,
    kAngle1,
    kAngle2,
    kCurvature1,
    kCurvature2,
    kBlur,
    kLevel,
    kSlopeX,
    kSlopeY,
    kContrast,
    kCount
};

/// I(x, y) minus the model, at every pixel of the window.
struct CornerResiduals {
    const cv::Mat& plane;
    int x0;
    int y0;
    int side;

    template <class T>
    bool operator()(const T* p, T* residuals) const {
        using std::cos;
        using std::sin;
        const T c1 = cos(p[kAngle1]);
        const T s1 = sin(p[kAngle1]);
        const T c2 = cos(p[kAngle2]);
        const T s2 = sin(p[kAngle2]);
        const T scale = T(1.0) / (T(std::numbers::sqrt2) * p[kBlur]);
        for (int j = 0; j < side; ++j) {
            for (int i = 0; i < side; ++i) {
                const T dx = T(x0 + i) - p[kX];
                const T dy = T(y0 + j) - p[kY];
                const T along1 = c1 * dx + s1 * dy;
                const T along2 = c2 * dx + s2 * dy;
                const T from1 = c1 * dy - s1 * dx + p[kCurvature1] * along1 * along1;
                const T from2 = c2 * dy - s2 * dx + p[kCurvature2] * along2 * along2;
                const T model = p[kLevel] + p[kSlopeX] * dx + p[kSlopeY] * dy +
                                p[kContrast] * smooth_step(from1 * scale) * smooth_step(from2 * scale);
                residuals[j * side + i] = model - T(static_cast<double>(plane.at<float>(y0 + j, x0 + i)));
            }
        }
        return true;
    }

    static double smooth_step(double x) { return std::erf(x); }

    template <int N>
    static ceres::Jet<double, N> smooth_step(const ceres::Jet<double, N>& x) {
        return ceres::Jet<double, N>(std::erf(x.a), 2.0 * std::numbers::inv_sqrtpi * std::exp(-x.a * x.a) * x.v);
    }
};

double angle_of(const Vec2d& v) {
    return std::atan2(v.y, v.x);
}

/// Mean light of the window, and the contrast's sign: the light in the quadrant between the two edges against the mean.
void start_light(const cv::Mat& plane, const CornerResiduals& window, std::array<double, kCount>& p) {
    double sum = 0.0;
    double projected = 0.0;
    for (int j = 0; j < window.side; ++j) {
        for (int i = 0; i < window.side; ++i) {
            const double dx = window.x0 + i - p[kX];
            const double dy = window.y0 + j - p[kY];
            const double from1 = std::cos(p[kAngle1]) * dy - std::sin(p[kAngle1]) * dx;
            const double from2 = std::cos(p[kAngle2]) * dy - std::sin(p[kAngle2]) * dx;
            const double light = plane.at<float>(window.y0 + j, window.x0 + i);
            sum += light;
            projected += from1 * from2 > 0.0 ? light : -light;
        }
    }
    const double pixels = static_cast<double>(window.side) * window.side;
    p[kLevel] = sum / pixels;
    p[kContrast] = projected / pixels;
}

}  // namespace

std::optional<Vec2d> fit_corner(const cv::Mat& plane, const CornerStart& start, int half_window) {
    const int side = 2 * half_window + 1;
    const int x0 = static_cast<int>(std::lround(start.corner_px.x)) - half_window;
    const int y0 = static_cast<int>(std::lround(start.corner_px.y)) - half_window;
    if (x0 < 0 || y0 < 0 || x0 + side > plane.cols || y0 + side > plane.rows) {
        return std::nullopt;
    }
    const CornerResiduals window{.plane = plane, .x0 = x0, .y0 = y0, .side = side};
    std::array<double, kCount> p{};
    p[kX] = start.corner_px.x;
    p[kY] = start.corner_px.y;
    p[kAngle1] = angle_of(start.along_first);
    p[kAngle2] = angle_of(start.along_second);
    p[kBlur] = 0.7;
    start_light(plane, window, p);
    const double level = p[kLevel];

    ceres::Problem problem;
    auto* cost = new ceres::AutoDiffCostFunction<CornerResiduals, ceres::DYNAMIC, kCount>(new CornerResiduals(window),
                                                                                          side * side);
    problem.AddResidualBlock(cost, nullptr, p.data());
    if (half_window < kCurvedFrom_px) {
        problem.SetManifold(p.data(), new ceres::SubsetManifold(kCount, {kCurvature1, kCurvature2}));
    }
    problem.SetParameterLowerBound(p.data(), kBlur, 0.2);
    problem.SetParameterUpperBound(p.data(), kBlur, half_window);
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::DENSE_QR;
    options.max_num_iterations = 30;
    options.function_tolerance = 1e-9;
    options.parameter_tolerance = 1e-7;
    options.num_threads = 1;
    options.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem, &summary);

    const double moved = std::hypot(p[kX] - start.corner_px.x, p[kY] - start.corner_px.y);
    const bool settled = summary.IsSolutionUsable() && summary.termination_type == ceres::CONVERGENCE;
    if (!settled || !(moved < kFarthest_px) || !(std::abs(p[kContrast]) > kLeastContrast * level) ||
        p[kBlur] > 0.5 * half_window) {
        return std::nullopt;
    }
    return Vec2d{p[kX], p[kY]};
}

}  // namespace lensproof
