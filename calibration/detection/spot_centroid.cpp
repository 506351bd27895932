#include "calibration/detection/spot_centroid.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace lensproof::calibration {
namespace {

constexpr int kRounds = 6;
constexpr double kMostFraction = 1.5;  // of a dark spot; a bright one may outshine its ground by any factor
constexpr double kFewestGround = 6.0;  // pixels

using PlaneRow = Eigen::Vector3d;

// The pixels around a place, by their distance from it in the window's units.
class Around {
  public:
    Around(const formats::Image& image, int channel, const Vec2d& at, const SpotWindow& window)
        : image_(image), channel_(channel), at_(at), window_(window) {
        const Vec2d& a = window.x_unit_px;
        const Vec2d& b = window.y_unit_px;
        determinant_ = a.x * b.y - a.y * b.x;
        reach_x_ = window.outer * std::hypot(a.x, b.x);
        reach_y_ = window.outer * std::hypot(a.y, b.y);
    }

    [[nodiscard]] bool is_in_picture() const {
        return std::abs(determinant_) > 1e-6 && at_.x - reach_x_ >= 0.0 && at_.y - reach_y_ >= 0.0 &&
               at_.x + reach_x_ <= image_.width - 1 && at_.y + reach_y_ <= image_.height - 1;
    }
    [[nodiscard]] double distance(double dx, double dy) const {
        const Vec2d& a = window_.x_unit_px;
        const Vec2d& b = window_.y_unit_px;
        return std::hypot((dx * b.y - dy * b.x) / determinant_, (dy * a.x - dx * a.y) / determinant_);
    }
    /// Calls `visit(dx, dy, light, distance)` for each pixel; false where one is no number.
    template <class Visit>
    bool each(const Visit& visit) const {
        for (int y = static_cast<int>(std::ceil(at_.y - reach_y_)); y <= std::floor(at_.y + reach_y_); ++y) {
            for (int x = static_cast<int>(std::ceil(at_.x - reach_x_)); x <= std::floor(at_.x + reach_x_); ++x) {
                const double light = image_.at(x, y, channel_);
                if (!std::isfinite(light)) {
                    return false;
                }
                visit(x - at_.x, y - at_.y, light, distance(x - at_.x, y - at_.y));
            }
        }
        return true;
    }

  private:
    const formats::Image& image_;
    int channel_;
    Vec2d at_;
    const SpotWindow& window_;
    double determinant_ = 0.0;
    double reach_x_ = 0.0;
    double reach_y_ = 0.0;
};

struct Ground {
    PlaneRow plane = PlaneRow::Zero();  // light = plane · (1, dx, dy)
    Eigen::Matrix3d inverse = Eigen::Matrix3d::Zero();
};

std::optional<Ground> ground_of(const Around& around, const SpotWindow& window) {
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    PlaneRow right = PlaneRow::Zero();
    const bool is_finite = around.each([&](double dx, double dy, double light, double distance) {
        if (distance > window.inner && distance < window.outer) {
            const PlaneRow row(1.0, dx, dy);
            normal += row * row.transpose();
            right += light * row;
        }
    });
    const Eigen::LDLT<Eigen::Matrix3d> solver(normal);
    if (!is_finite || normal(0, 0) < kFewestGround || solver.info() != Eigen::Success || solver.rcond() < 1e-9) {
        return std::nullopt;
    }
    return Ground{.plane = solver.solve(right), .inverse = solver.solve(Eigen::Matrix3d::Identity())};
}

std::optional<Spot> centroid(const formats::Image& image, int channel, const Vec2d& start, const SpotWindow& window) {
    const Around around(image, channel, start, window);
    const auto ground = around.is_in_picture() ? ground_of(around, window) : std::optional<Ground>();
    if (!ground) {
        return std::nullopt;
    }
    const double unit_px = std::min(std::hypot(window.x_unit_px.x, window.x_unit_px.y),
                                    std::hypot(window.y_unit_px.x, window.y_unit_px.y));
    // Of a dark spot by the light that falls on it, which the ground shows; black ground shows that too noisily.
    const auto scale_at = [&](double level) { return window.is_bright ? -ground->plane(0) : level; };
    const auto fraction_at = [&](double distance) {
        return std::clamp((window.inner - distance) * unit_px + 0.5, 0.0, 1.0);
    };
    double mass = 0.0;
    Vec2d moment;
    around.each([&](double dx, double dy, double light, double distance) {
        const double level = ground->plane.dot(PlaneRow(1.0, dx, dy));
        const double fraction = fraction_at(distance);
        if (level > 0.0 && fraction > 0.0) {
            const double contrast = fraction * (level - light) / scale_at(level);
            mass += contrast;
            moment = {moment.x + contrast * dx, moment.y + contrast * dy};
        }
    });
    const double whole = mass / window.area_px;
    if (!(whole > window.least_fraction) || (!window.is_bright && whole > kMostFraction)) {
        return std::nullopt;
    }
    const Vec2d off{moment.x / mass, moment.y / mass};
    // What a pixel's light does to the centroid: by itself, inside, and by the ground's plane.
    Vec2d squares;
    PlaneRow of_plane_x = PlaneRow::Zero();
    PlaneRow of_plane_y = PlaneRow::Zero();
    around.each([&](double dx, double dy, double light, double distance) {
        const PlaneRow row(1.0, dx, dy);
        const double level = ground->plane.dot(row);
        const double fraction = fraction_at(distance);
        if (level > 0.0 && fraction > 0.0) {
            const double weight = fraction / (scale_at(level) * mass);
            squares.x += weight * weight * (dx - off.x) * (dx - off.x);
            squares.y += weight * weight * (dy - off.y) * (dy - off.y);
            const double by_level = window.is_bright ? weight : weight * light / level;
            of_plane_x += by_level * (dx - off.x) * row;
            of_plane_y += by_level * (dy - off.y) * row;
        }
    });
    return Spot{.centre_px = {start.x + off.x, start.y + off.y},
                .standard_error_px = {std::sqrt(squares.x + of_plane_x.dot(ground->inverse * of_plane_x)),
                                      std::sqrt(squares.y + of_plane_y.dot(ground->inverse * of_plane_y))}};
}

}  // namespace

std::optional<Spot> locate_spot(const formats::Image& image, int channel, const Vec2d& start,
                                const SpotWindow& window) {
    std::optional<Spot> spot = Spot{.centre_px = start, .standard_error_px = {}};
    for (int round = 0; round < kRounds && spot; ++round) {
        spot = centroid(image, channel, spot->centre_px, window);
        if (spot &&
            Around(image, channel, start, window).distance(spot->centre_px.x - start.x, spot->centre_px.y - start.y) >
                0.5 * window.outer) {
            return std::nullopt;
        }
    }
    return spot;
}

}  // namespace lensproof::calibration
