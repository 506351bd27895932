#include "calibration/geometry/geometry_curves.h"

#include <algorithm>
#include <cmath>

#include "engine/base/angle.h"

namespace lensproof::calibration {
namespace {

// A quantity that the model says about the radius `r`, px; none where it says nothing.
using RadialQuantity = std::optional<double> (*)(const CameraModel& model, double r);

std::optional<double> angle_deg(const CameraModel& model, double r) {
    const auto angle = field_angle_rad(model, r);
    return angle ? std::optional(*angle / kDegree) : std::nullopt;
}

std::optional<double> rectilinear_percent(const CameraModel& model, double r) {
    const auto angle = field_angle_rad(model, r);
    if (!angle || *angle >= 89.0 * kDegree) {
        return std::nullopt;
    }
    return r > 0.0 ? 100.0 * (r / (focal_length_px(model) * std::tan(*angle)) - 1.0) : 0.0;
}

std::optional<double> equidistant_percent(const CameraModel& model, double r) {
    const auto angle = field_angle_rad(model, r);
    if (!angle) {
        return std::nullopt;
    }
    return r > 0.0 ? 100.0 * (r / (focal_length_px(model) * *angle) - 1.0) : 0.0;
}

// Standard error of `quantity` by the delta method. Central differences over a tenth of each standard error: far above
// rounding and, because a fit with large errors is refused earlier, far inside the model's linear range.
double standard_error(const GeometryFit& fit, RadialQuantity quantity, double r) {
    const std::vector<double> centre = parameters(fit.model);
    const std::size_t count = centre.size();
    std::vector<double> gradient(count, 0.0);
    for (std::size_t i = 0; i < count; ++i) {
        const double step =
            std::max(0.1 * fit.standard_error(static_cast<int>(i)), 1e-9 * std::max(1.0, std::abs(centre[i])));
        if (fit.covariance[i * (count + 1)] == 0.0) {
            continue;
        }
        auto shifted = centre;
        shifted[i] = centre[i] + step;
        const auto above = quantity(with_parameters(fit.model, shifted), r);
        shifted[i] = centre[i] - step;
        const auto below = quantity(with_parameters(fit.model, shifted), r);
        const auto here = quantity(fit.model, r);
        if (above && below) {
            gradient[i] = (*above - *below) / (2.0 * step);
        } else if (above && here) {  // at the end of the model's reach
            gradient[i] = (*above - *here) / step;
        } else if (below && here) {
            gradient[i] = (*here - *below) / step;
        }
    }
    double variance = 0.0;
    for (std::size_t i = 0; i < count; ++i) {
        for (std::size_t j = 0; j < count; ++j) {
            variance += gradient[i] * fit.covariance[i * count + j] * gradient[j];
        }
    }
    return std::sqrt(std::max(variance, 0.0));
}

Curve curve_of(const GeometryFit& fit, double half_diagonal_px, RadialQuantity quantity) {
    Curve curve;
    curve.covered_image_height = fit.covered_radius_px / half_diagonal_px;
    for (const double height : standard_image_heights()) {
        const double r = height * half_diagonal_px;
        const auto value = quantity(fit.model, r);
        if (!value) {
            break;
        }
        const double half_width = r > 0.0 ? k95 * standard_error(fit, quantity, r) : 0.0;
        append(curve, height, {*value, *value - half_width, *value + half_width});
    }
    return curve;
}

}  // namespace

Curve field_angle_curve(const GeometryFit& fit, double half_diagonal_px) {
    return curve_of(fit, half_diagonal_px, angle_deg);
}

Curve rectilinear_distortion_curve(const GeometryFit& fit, double half_diagonal_px) {
    return curve_of(fit, half_diagonal_px, rectilinear_percent);
}

Curve equidistant_distortion_curve(const GeometryFit& fit, double half_diagonal_px) {
    return curve_of(fit, half_diagonal_px, equidistant_percent);
}

}  // namespace lensproof::calibration
