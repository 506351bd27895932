#include "calibration/sharpness/star_map.h"

#include <Eigen/LU>
#include <numbers>

#include "calibration/statistics/dense_solvers.h"
#include "engine/base/angle.h"

namespace lensproof::calibration {
namespace {

double determinant_of(const StarMap& map) {
    return map.x_axis.x * map.y_axis.y - map.y_axis.x * map.x_axis.y;
}

// A⁻¹ d.
Vec2d on_chart(const StarMap& map, const Vec2d& d) {
    const double determinant = determinant_of(map);
    return {(map.y_axis.y * d.x - map.y_axis.x * d.y) / determinant,
            (map.x_axis.x * d.y - map.x_axis.y * d.x) / determinant};
}

}  // namespace

std::array<double, StarMap::kBendTerms> StarMap::bend_terms(const Vec2d& p) const {
    const Vec2d q = on_chart(*this, {p.x - centre_px.x, p.y - centre_px.y});
    const double scale = radius_px * radius_px / (determinant_of(*this) * (q.x * q.x + q.y * q.y));
    const Vec2d offset{(p.x - centre_px.x) / radius_px, (p.y - centre_px.y) / radius_px};
    std::array<double, kBendTerms> terms{};
    std::array<double, 5> of_x{1.0};
    std::array<double, 5> of_y{1.0};
    for (std::size_t k = 1; k < of_x.size(); ++k) {
        of_x[k] = of_x[k - 1] * offset.x;
        of_y[k] = of_y[k - 1] * offset.y;
    }
    std::size_t next = 0;
    for (std::size_t degree = 1; degree < of_x.size(); ++degree) {
        for (std::size_t k = 0; k <= degree; ++k) {
            terms[next++] = scale * of_x[degree - k] * of_y[k];
        }
    }
    return terms;
}

double StarMap::angle(const Vec2d& p) const {
    const Vec2d q = on_chart(*this, {p.x - centre_px.x, p.y - centre_px.y});
    double sum = std::atan2(q.y, q.x);
    const auto terms = bend_terms(p);
    for (std::size_t i = 0; i < terms.size(); ++i) {
        sum += bend[i] * terms[i];
    }
    return sum;
}

double StarMap::angle_per_px(const Vec2d& p) const {
    constexpr double kStep_px = 0.25;
    const auto slope = [&](double dx, double dy) {
        const double apart = angle({p.x + dx, p.y + dy}) - angle({p.x - dx, p.y - dy});
        return std::remainder(apart, 2.0 * std::numbers::pi) / (2.0 * kStep_px);
    };
    return std::hypot(slope(kStep_px, 0.0), slope(0.0, kStep_px));
}

Vec2d StarMap::direction(double angle_rad) const {
    const double c = std::cos(angle_rad);
    const double s = std::sin(angle_rad);
    const Vec2d d{c * x_axis.x + s * y_axis.x, c * x_axis.y + s * y_axis.y};
    const double length = std::hypot(d.x, d.y);
    return {d.x / length, d.y / length};
}

double StarMap::rim_px(const Vec2d& p, double radius_mm) const {
    const Vec2d d{p.x - centre_px.x, p.y - centre_px.y};
    const Vec2d q = on_chart(*this, d);
    const double length = std::hypot(d.x, d.y);
    // q = R q̂ is seen at A q̂ R / (1 + R g·q̂).
    const double mm = std::hypot(q.x, q.y);
    const double towards = radius_mm * (perspective.x * q.x + perspective.y * q.y) / mm;
    return length / mm * radius_mm / (1.0 + towards);
}

EllipseOutline outline(const StarMap& map, double radius_mm) {
    Eigen::Matrix3d homography;  // from the circle's radius as unit
    homography << radius_mm * map.x_axis.x, radius_mm * map.y_axis.x, 0.0, radius_mm * map.x_axis.y,
        radius_mm * map.y_axis.y, 0.0, radius_mm * map.perspective.x, radius_mm * map.perspective.y, 1.0;
    const Eigen::Matrix3d inverse = homography.inverse();
    const Eigen::Matrix3d circle = Eigen::Vector3d(1.0, 1.0, -1.0).asDiagonal();
    const Eigen::Matrix3d conic = inverse.transpose() * circle * inverse;
    const Eigen::Matrix2d form = conic.topLeftCorner<2, 2>();
    const Eigen::Vector2d middle = -form.inverse() * conic.topRightCorner<2, 1>();
    const double level = -(conic(2, 2) + conic.topRightCorner<2, 1>().dot(middle));
    const SymmetricEigen axes = symmetric_eigen(form);  // ascending: the longer axis first
    const Eigen::Vector2d along = axes.vectors.col(0);
    double angle = degrees(std::atan2(along(1), along(0)));
    angle -= angle > 90.0 ? 180.0 : angle <= -90.0 ? -180.0 : 0.0;
    return {.centre_px = {map.centre_px.x + middle(0), map.centre_px.y + middle(1)},
            .long_half_axis_px = std::sqrt(level / axes.values(0)),
            .short_half_axis_px = std::sqrt(level / axes.values(1)),
            .angle_deg = angle};
}

}  // namespace lensproof::calibration
