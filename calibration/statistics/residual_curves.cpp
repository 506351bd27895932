#include "calibration/statistics/residual_curves.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "calibration/statistics/student.h"
#include "engine/base/angle.h"

namespace lensproof::calibration {

namespace {

constexpr double kDensityBin = 0.25;
constexpr double kDensityEnd = 5.0;

/// The means of values in bins over x.
class BinnedMeans {
  public:
    BinnedMeans(double first, double width, std::size_t count) : first_(first), width_(width), bins_(count) {}

    void add(double x, double value) {
        const auto bin = static_cast<std::size_t>(std::max(0.0, (x - first_) / width_));
        Bin& to = bins_[std::min(bin, bins_.size() - 1)];
        ++to.count;
        to.x += x;
        to.sum += value;
        to.squares += value * value;
    }

    [[nodiscard]] Curve curve() const {
        Curve curve;
        for (const Bin& bin : bins_) {
            if (bin.count < kLeastResiduals) {
                continue;
            }
            const double n = bin.count;
            const double mean = bin.sum / n;
            const double variance = std::max(0.0, (bin.squares - n * mean * mean) / (n - 1.0));
            const double half = student_95(n - 1.0) * std::sqrt(variance / n);
            append(curve, bin.x / n, {mean, mean - half, mean + half});
            curve.covered_image_height = bin.x / n;
        }
        return curve;
    }

  private:
    struct Bin {
        int count = 0;
        double x = 0.0;
        double sum = 0.0;
        double squares = 0.0;
    };

    double first_;
    double width_;
    std::vector<Bin> bins_;
};

/// 95 % bounds by the counts' Poisson error.
Curve density_of(const std::vector<PlacedResidual>& residuals, double rms_px) {
    const auto bins = static_cast<std::size_t>(2.0 * kDensityEnd / kDensityBin);
    std::vector<int> counts(bins);
    for (const PlacedResidual& residual : residuals) {
        for (const double by : {residual.by_px.x, residual.by_px.y}) {
            const double place = std::floor((by / rms_px + kDensityEnd) / kDensityBin);
            if (place >= 0.0 && place < static_cast<double>(bins)) {
                ++counts[static_cast<std::size_t>(place)];
            }
        }
    }
    Curve curve;
    const double unit = 1.0 / (2.0 * static_cast<double>(residuals.size()) * kDensityBin);
    for (std::size_t i = 0; i < bins; ++i) {
        const double x = -kDensityEnd + (static_cast<double>(i) + 0.5) * kDensityBin;
        const double half = k95 * std::sqrt(counts[i]);
        append(curve, x, {unit * counts[i], unit * std::max(0.0, counts[i] - half), unit * (counts[i] + half)});
    }
    curve.covered_image_height = kDensityEnd;
    return curve;
}

}  // namespace

ResidualCurves residual_curves(const std::vector<PlacedResidual>& residuals, const Vec2d& centre_px,
                               double half_diagonal_px) {
    constexpr double kHeightBin = 0.05;
    constexpr double kAzimuthBin = 15.0;
    const std::size_t heights = 24;  // to 1.2: the centre need not be the frame's
    BinnedMeans radial(0.0, kHeightBin, heights);
    BinnedMeans tangential = radial;
    BinnedMeans radial_azimuth(0.0, kAzimuthBin, static_cast<std::size_t>(360.0 / kAzimuthBin));
    BinnedMeans tangential_azimuth = radial_azimuth;
    double squares = 0.0;
    for (const PlacedResidual& residual : residuals) {
        squares += dot(residual.by_px, residual.by_px);
        const Vec2d from = residual.at_px - centre_px;
        const double distance = length(from);
        const Vec2d outwards = distance > 0.0 ? from / distance : Vec2d{1.0, 0.0};
        const double along = dot(residual.by_px, outwards);
        const double across = residual.by_px.y * outwards.x - residual.by_px.x * outwards.y;
        const double azimuth = degrees(std::atan2(from.y, from.x));
        const double turned = azimuth < 0.0 ? azimuth + 360.0 : azimuth;
        radial.add(distance / half_diagonal_px, along);
        tangential.add(distance / half_diagonal_px, across);
        radial_azimuth.add(turned, along);
        tangential_azimuth.add(turned, across);
    }
    const double coordinates = 2.0 * static_cast<double>(residuals.size());
    const double rms = std::sqrt(squares / coordinates);
    double beyond = 0.0;
    for (const PlacedResidual& residual : residuals) {
        beyond += std::abs(residual.by_px.x) > 3.0 * rms ? 1.0 : 0.0;
        beyond += std::abs(residual.by_px.y) > 3.0 * rms ? 1.0 : 0.0;
    }
    return {.rms_px = rms,
            .beyond_3 = beyond / coordinates,
            .density = density_of(residuals, rms),
            .radial = radial.curve(),
            .tangential = tangential.curve(),
            .radial_azimuth = radial_azimuth.curve(),
            .tangential_azimuth = tangential_azimuth.curve()};
}

Curve gaussian_density(const Curve& density) {
    Curve curve;
    for (const double x : density.image_height) {
        const double y = std::exp(-0.5 * x * x) / std::sqrt(2.0 * std::numbers::pi);
        append(curve, x, {y, y, y});
    }
    curve.covered_image_height = density.covered_image_height;
    return curve;
}

std::vector<double> local_rms_px(const std::vector<PlacedResidual>& residuals, int width_px, int height_px, int columns,
                                 int rows) {
    constexpr double kLeastWeight = 4.0;
    const double step_x = (width_px - 1.0) / (columns - 1.0);
    const double step_y = (height_px - 1.0) / (rows - 1.0);
    const double sigma = 0.75 * std::max(step_x, step_y);
    std::vector<double> values;
    values.reserve(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
    for (int row = 0; row < rows; ++row) {
        for (int column = 0; column < columns; ++column) {
            double sum = 0.0;
            double weights = 0.0;
            double squared_weights = 0.0;
            for (const PlacedResidual& residual : residuals) {
                const Vec2d away = residual.at_px - Vec2d{column * step_x, row * step_y};
                const double weight = std::exp(-0.5 * dot(away, away) / (sigma * sigma));
                sum += weight * 0.5 * dot(residual.by_px, residual.by_px);
                weights += weight;
                squared_weights += weight * weight;
            }
            // Points that count by w count as (Σw)² / Σw² of them; far ones by nearly nothing.
            const bool is_known = weights > 1.0 && weights * weights > kLeastWeight * squared_weights;
            values.push_back(is_known ? std::sqrt(sum / weights) : std::nan(""));
        }
    }
    return values;
}

}  // namespace lensproof::calibration
