#include "calibration/comparison/light_spot.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>

#include "engine/base/angle.h"
#include "engine/base/input_error.h"
#include "engine/base/order_statistics.h"

namespace lensproof::calibration {

namespace {

constexpr int kLeastSide_px = 10;
constexpr double kLeastSignal = 5.0;  // standard errors of the light

/// A box's pixels in one plane of the picture.
struct Box {
    int width = 0;
    int height = 0;
    std::vector<double> values;

    [[nodiscard]] std::size_t index(int x, int y) const {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
    }
    [[nodiscard]] double at(int x, int y) const { return values[index(x, y)]; }
    /// Whether it shows what is about the light.
    [[nodiscard]] bool is_margin(int x, int y) const {
        const int across = std::max(1, width / 10);
        const int down = std::max(1, height / 10);
        return x < across || y < down || x >= width - across || y >= height - down;
    }
    /// Of a pixel, from the box's middle.
    [[nodiscard]] Vec2d place(int x, int y) const { return {x - 0.5 * (width - 1), y - 0.5 * (height - 1)}; }
};

/// The mean of the channels that `weights` name.
Box box_of(const formats::Image& image, const PixelRectangle& box, const std::vector<double>& weights) {
    Box plane{.width = box.width, .height = box.height, .values = {}};
    for (int y = 0; y < box.height; ++y) {
        for (int x = 0; x < box.width; ++x) {
            double value = 0.0;
            for (int c = 0; c < image.channel_count(); ++c) {
                value += weights[static_cast<std::size_t>(c)] * image.at(box.x + x, box.y + y, c);
            }
            plane.values.push_back(value);
        }
    }
    return plane;
}

Eigen::Vector3d plane_terms(const Vec2d& at) {
    return {1.0, at.x, at.y};
}

/// The light of a plane: its pixels less what is about it, and how sure each is.
class Light {
  public:
    explicit Light(Box box) : box_(std::move(box)) {
        take_plane_off();
        find_noise();
    }

    [[nodiscard]] const Box& box() const { return box_; }

    /// Σ of weight(place, light) over the pixels within the margin.
    template <class Weight>
    double sum(const Weight& weight) const {
        double total = 0.0;
        each([&](int x, int y) { total += weight(box_.place(x, y)) * box_.at(x, y); });
        return total;
    }

    /// The standard error of that sum: noise of the pixels within, and of those of the margin through the plane.
    template <class Weight>
    double error(const Weight& weight) const {
        double variance = 0.0;
        Eigen::Vector3d by_plane = Eigen::Vector3d::Zero();
        each([&](int x, int y) {
            const Vec2d at = box_.place(x, y);
            const double w = weight(at);
            const double noise = box_.at(x, y) > half_ ? noise_lit_ : noise_beside_;
            variance += w * w * noise * noise;
            by_plane += w * plane_terms(at);
        });
        return std::sqrt(variance + noise_beside_ * noise_beside_ * by_plane.dot(plane_covariance_ * by_plane));
    }

    /// Half of what the brightest tenth within shows.
    [[nodiscard]] double half() const { return half_; }

  private:
    template <class Visit>
    void each(const Visit& visit) const {
        for (int y = 0; y < box_.height; ++y) {
            for (int x = 0; x < box_.width; ++x) {
                if (!box_.is_margin(x, y)) {
                    visit(x, y);
                }
            }
        }
    }

    void take_plane_off() {
        Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
        Eigen::Vector3d right = Eigen::Vector3d::Zero();
        for (int y = 0; y < box_.height; ++y) {
            for (int x = 0; x < box_.width; ++x) {
                if (box_.is_margin(x, y)) {
                    const Eigen::Vector3d terms = plane_terms(box_.place(x, y));
                    normal += terms * terms.transpose();
                    right += box_.at(x, y) * terms;
                }
            }
        }
        plane_covariance_ = normal.inverse();
        const Eigen::Vector3d plane = plane_covariance_ * right;
        for (int y = 0; y < box_.height; ++y) {
            for (int x = 0; x < box_.width; ++x) {
                box_.values[box_.index(x, y)] -= plane.dot(plane_terms(box_.place(x, y)));
            }
        }
    }

    /// Of a pixel's difference from the mean of its four neighbours the variance is 5/4 of its own.
    void find_noise() {
        std::vector<double> within;
        each([&](int x, int y) { within.push_back(box_.at(x, y)); });
        half_ = 0.5 * quantile(within, 0.9);
        std::vector<double> lit;
        std::vector<double> beside;
        for (int y = 1; y + 1 < box_.height; ++y) {
            for (int x = 1; x + 1 < box_.width; ++x) {
                const double around =
                    0.25 * (box_.at(x - 1, y) + box_.at(x + 1, y) + box_.at(x, y - 1) + box_.at(x, y + 1));
                (box_.at(x, y) > half_ ? lit : beside).push_back(std::abs(box_.at(x, y) - around));
            }
        }
        const auto noise = [](std::vector<double>& off) {
            return off.empty() ? 0.0 : kSigmaPerMedian * std::sqrt(0.8) * median(off);
        };
        noise_beside_ = noise(beside);
        noise_lit_ = std::max(noise_beside_, noise(lit));
    }

    Box box_;
    Eigen::Matrix3d plane_covariance_;  // over the variance of a pixel
    double half_ = 0.0;
    double noise_beside_ = 0.0;
    double noise_lit_ = 0.0;
};

/// Half of a turn further is the same axis.
double axis_deg(const Eigen::Vector2d& axis) {
    const double angle = std::atan2(axis.y(), axis.x()) / kDegree;
    return angle > 90.0 ? angle - 180.0 : angle <= -90.0 ? angle + 180.0 : angle;
}

/// Every moment is a sum of light times a polynomial of the place, and so is what it is to first order.
void fill_moments(const Light& light, const PixelRectangle& box, const std::string& words, LightSpot& spot) {
    const double total = light.sum([](const Vec2d&) { return 1.0; });
    const Vec2d centre{light.sum([](const Vec2d& at) { return at.x; }) / total,
                       light.sum([](const Vec2d& at) { return at.y; }) / total};
    const auto place = [&](double middle, double offset, const auto& coordinate) {
        return Estimate{middle + offset,
                        light.error([&](const Vec2d& at) { return (coordinate(at) - offset) / total; })};
    };
    spot.x_px = place(box.x + 0.5 * (box.width - 1), centre.x, [](const Vec2d& at) { return at.x; });
    spot.y_px = place(box.y + 0.5 * (box.height - 1), centre.y, [](const Vec2d& at) { return at.y; });
    Eigen::Matrix2d spread;
    const auto square = [&](const auto& product) {
        return light.sum([&](const Vec2d& at) { return product(at - centre); }) / total;
    };
    spread(0, 0) = square([](const Vec2d& off) { return off.x * off.x; });
    spread(1, 1) = square([](const Vec2d& off) { return off.y * off.y; });
    spread(0, 1) = spread(1, 0) = square([](const Vec2d& off) { return off.x * off.y; });
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(spread);
    const double minor = axes.eigenvalues()[0];
    const double major = axes.eigenvalues()[1];
    if (!(minor > 0.0)) {
        throw InputError(fmt::format("the box {}: the light has no width", words));
    }
    const Eigen::Vector2d along = axes.eigenvectors().col(1);
    const Eigen::Vector2d across = axes.eigenvectors().col(0);
    // Of variances v along the axes of an even ellipse these are 4 √v long.
    spot.diameter_px.value = 4.0 * std::pow(minor * major, 0.25);
    spot.elongation.value = std::sqrt(major / minor);
    spot.angle_deg.value = axis_deg(along);
    const auto projected = [&](const Vec2d& at, const Eigen::Vector2d& axis) {
        return (at.x - centre.x) * axis.x() + (at.y - centre.y) * axis.y();
    };
    const auto relative = [&](const Vec2d& at, const Eigen::Vector2d& axis, double variance) {
        const double off = projected(at, axis);
        return (off * off / variance - 1.0) / total;
    };
    spot.diameter_px.standard_error = 0.25 * spot.diameter_px.value * light.error([&](const Vec2d& at) {
        return relative(at, along, major) + relative(at, across, minor);
    });
    spot.elongation.standard_error = 0.5 * spot.elongation.value * light.error([&](const Vec2d& at) {
        return relative(at, along, major) - relative(at, across, minor);
    });
    spot.angle_deg.standard_error =
        light.error([&](const Vec2d& at) { return projected(at, along) * projected(at, across) / total; }) /
        std::max(major - minor, 1e-12 * major) / kDegree;
}

}  // namespace

Estimate LightSpot::colour_ev(int channel, int over) const {
    const Estimate& a = light[static_cast<std::size_t>(channel)];
    const Estimate& b = light[static_cast<std::size_t>(over)];
    return {std::log2(a.value / b.value),
            std::hypot(a.standard_error / a.value, b.standard_error / b.value) / std::log(2.0)};
}

LightSpot measure_spot(const formats::Image& image, const PixelRectangle& box, double clipped_from) {
    const std::string words = fmt::format("{},{},{},{}", box.x, box.y, box.width, box.height);
    if (box.width < kLeastSide_px || box.height < kLeastSide_px || box.x < 0 || box.y < 0 ||
        box.x + box.width > image.width || box.y + box.height > image.height) {
        throw InputError(
            fmt::format("the box {} in a picture of {} × {} px: expected it within, of {} px a side or more", words,
                        image.width, image.height, kLeastSide_px));
    }
    const auto channels = static_cast<std::size_t>(image.channel_count());
    LightSpot spot;
    const Light all(box_of(image, box, std::vector<double>(channels, 1.0 / static_cast<double>(channels))));
    const auto one = [](const Vec2d&) { return 1.0; };
    if (!(all.sum(one) > kLeastSignal * all.error(one))) {
        throw InputError(fmt::format("the box {}: no light stands out of what is about it", words));
    }
    fill_moments(all, box, words, spot);
    for (std::size_t c = 0; c < channels; ++c) {
        std::vector<double> weights(channels, 0.0);
        weights[c] = 1.0;
        const Light light(box_of(image, box, weights));
        spot.light.push_back({light.sum(one), light.error(one)});
    }
    int lit = 0;
    int clipped = 0;
    for (int y = 0; y < box.height; ++y) {
        for (int x = 0; x < box.width; ++x) {
            if (all.box().at(x, y) > all.half()) {
                ++lit;
                float most = 0.0F;
                for (int c = 0; c < image.channel_count(); ++c) {
                    most = std::max(most, image.at(box.x + x, box.y + y, c));
                }
                clipped += most >= clipped_from ? 1 : 0;
            }
        }
    }
    spot.clipped_fraction = lit == 0 ? 0.0 : static_cast<double>(clipped) / lit;
    return spot;
}

}  // namespace lensproof::calibration
