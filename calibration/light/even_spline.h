// calibration/light/even_spline.h — a curve over the image height that is even about the axis and 0 there.
#pragma once
#include <Eigen/Core>
#include <cmath>

namespace lensproof::calibration {

/// s(r) = Σ c_i φ_i(r), a uniform cubic B-spline from r = 0 to `reach`, mirrored at 0; s(0) = 0.
struct EvenSpline {
    int spans = 1;
    double reach = 1.0;  // the outermost knot

    [[nodiscard]] int size() const { return spans + 1; }

    [[nodiscard]] Eigen::RowVectorXd basis(double r) const {
        const double t = r * spans / reach;
        Eigen::RowVectorXd phi(size());
        for (int i = 0; i < size(); ++i) {
            phi(i) = cardinal_cubic(t - (i + 1));
        }
        phi(0) += cardinal_cubic(t + 1.0) - 1.0 / 3.0;  // the mirror image, and its value on the axis
        return phi;
    }

    /// Third differences of the coefficients, one row a span: 0 of a parabola a r², as which a falloff begins.
    [[nodiscard]] Eigen::MatrixXd third_differences() const {
        constexpr double binomial[] = {-1.0, 3.0, -3.0, 1.0};
        Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(spans, size());
        for (int row = 0; row < spans; ++row) {
            for (int k = 0; k < 4; ++k) {
                if (const int at = std::abs(row - 1 + k); at > 0) {  // mirrored; the one on the axis is 0
                    rows(row, at - 1) += binomial[k];
                }
            }
        }
        return rows;
    }

  private:
    static double cardinal_cubic(double t) {  // support [-2, 2]
        const double a = std::abs(t);
        if (a >= 2.0) {
            return 0.0;
        }
        return a >= 1.0 ? (2.0 - a) * (2.0 - a) * (2.0 - a) / 6.0 : 2.0 / 3.0 - a * a * (1.0 - 0.5 * a);
    }
};

}  // namespace lensproof::calibration
