#include "calibration/photographed/lens_agreement.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/base/angle.h"

namespace lensproof::calibration {

namespace {

constexpr double kLeastReach = 0.1;
constexpr double kLargestTangentField = 89.0 * kDegree;
constexpr int kFits = 50;

/// A direction that both lenses image; mm.
struct SharedDirection {
    double ideal = 0.0;      // g(θ) of the photographed lens's projection
    double simulated = 0.0;  // green's height
    double weight = 0.0;     // fraction of the heights that it stands for
};

/// Each stands for the heights nearer to it than to its neighbours.
void weigh_evenly(std::vector<SharedDirection>& directions) {
    const std::size_t n = directions.size();
    double total = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
        const double below = directions[i == 0 ? 0 : i - 1].simulated;
        const double above = directions[std::min(i + 1, n - 1)].simulated;
        directions[i].weight = 0.5 * (above - below);
        total += directions[i].weight;
    }
    for (SharedDirection& direction : directions) {
        direction.weight /= total;
    }
}

/// Up to green's image height `edge_mm`, as far as the projection images one to one.
std::vector<SharedDirection> imaged_directions(const ImagedField& simulated, optics::Projection projection,
                                               double edge_mm) {
    std::vector<SharedDirection> directions;
    for (std::size_t i = 0; i < simulated.field_angle.size() && simulated.green(i) <= edge_mm * (1.0 + 1e-6); ++i) {
        const double angle = simulated.field_angle[i];
        if (projection == optics::Projection::rectilinear && angle > kLargestTangentField) {
            break;
        }
        const double ideal = optics::projected_radius(projection, angle);
        if (!directions.empty() && !(ideal > directions.back().ideal)) {
            break;
        }
        directions.push_back({.ideal = ideal, .simulated = simulated.green(i), .weight = 0.0});
    }
    return directions;
}

/// Drops the directions beyond which the photographed lens images no farther out.
void keep_photographed(double scale_mm, double covered_mm, std::vector<SharedDirection>& directions) {
    while (directions.size() > 2 && scale_mm * directions.back().ideal > covered_mm) {
        directions.pop_back();
    }
    weigh_evenly(directions);
}

/// Gauss–Newton in F. The residuals are nearly straight in it, so that it settles in a few steps.
double fitted_scale(const PhotographedLens& photographed, const std::vector<SharedDirection>& directions,
                    double scale_mm) {
    for (int i = 0; i < kFits; ++i) {
        double slope_error = 0.0;
        double slope_slope = 0.0;
        for (const SharedDirection& at : directions) {
            const double ideal_mm = scale_mm * at.ideal;
            const double slope = photographed_slope(photographed, ideal_mm) * at.ideal;
            slope_error += at.weight * slope * (photographed_radius(photographed, ideal_mm) - at.simulated);
            slope_slope += at.weight * slope * slope;
        }
        const double step = slope_error / slope_slope;
        scale_mm -= step;
        if (!(std::abs(step) > 1e-12 * scale_mm)) {
            break;
        }
    }
    return scale_mm;
}

/// Sums over heights, each with its weight.
class ResidualSum {
  public:
    void add(double difference_mm, double weight) {
        squares_ += weight * difference_mm * difference_mm;
        largest_ = std::max(largest_, std::abs(difference_mm));
        total_ += weight;
    }
    [[nodiscard]] Residual residual() const {
        return {.rms_um = 1e3 * std::sqrt(squares_ / total_), .largest_um = 1e3 * largest_};
    }

  private:
    double squares_ = 0.0;
    double largest_ = 0.0;
    double total_ = 0.0;
};

ShiftAgreement shift_agreement(const PhotographedLens& photographed, const ChannelRadius& colour,
                               const ImagedField& simulated, std::size_t channel) {
    ShiftAgreement agreement;
    ResidualSum sum;
    const double edge = photographed.half_diagonal_mm();
    for (std::size_t i = 0; i < simulated.field_angle.size() && simulated.green(i) <= edge * (1.0 + 1e-6); ++i) {
        const double green = simulated.green(i);
        const double seen = channel_shift(photographed, colour, green);
        const double traced = simulated.height_mm[i][channel] - green;
        const double below = simulated.green(i == 0 ? 0 : i - 1);
        const double above = simulated.green(std::min(i + 1, simulated.field_angle.size() - 1));
        sum.add(seen - traced, 0.5 * (above - below));
        agreement.photographed_um.push_back({green / edge, 1e3 * seen});
        agreement.simulated_um.push_back({green / edge, 1e3 * traced});
    }
    agreement.residual = sum.residual();
    return agreement;
}

}  // namespace

std::optional<DistortionAgreement> distortion_agreement(const PhotographedLens& photographed,
                                                        const ImagedField& simulated) {
    const double edge = photographed.half_diagonal_mm();
    std::vector<SharedDirection> directions = imaged_directions(simulated, photographed.projection, edge);
    if (photographed.distortion_model.empty() || directions.size() < 3) {
        return std::nullopt;
    }
    const double focal = simulated.focal_length_mm[1];
    if (!(focal > 0.0)) {
        return std::nullopt;
    }
    const double covered = ideal_radius_covered(photographed, 4.0 * edge);
    double scale_mm = focal / photographed.distortion[0];
    for (int i = 0; i < 3; ++i) {
        keep_photographed(scale_mm, covered, directions);
        scale_mm = fitted_scale(photographed, directions, scale_mm);
    }
    DistortionAgreement agreement{.residual = {},
                                  .scale = scale_mm * photographed.distortion[0] / focal,
                                  .reach = directions.back().simulated / edge};
    if (!(agreement.reach >= kLeastReach) || !std::isfinite(scale_mm)) {
        return std::nullopt;
    }
    ResidualSum sum;
    for (const SharedDirection& at : directions) {
        const double seen = photographed_radius(photographed, scale_mm * at.ideal);
        sum.add(seen - at.simulated, at.weight);
        const bool is_axis = at.ideal == 0.0;
        const double ideal_mm = focal * at.ideal;
        agreement.photographed_percent.push_back(
            {at.simulated / edge, 100.0 * ((is_axis ? agreement.scale : seen / ideal_mm) - 1.0)});
        agreement.simulated_percent.push_back(
            {at.simulated / edge, is_axis ? 0.0 : 100.0 * (at.simulated / ideal_mm - 1.0)});
    }
    agreement.residual = sum.residual();
    return agreement;
}

double departure_from_ideal(const ImagedField& simulated, optics::Projection projection, double edge_mm) {
    std::vector<SharedDirection> directions = imaged_directions(simulated, projection, edge_mm);
    if (directions.size() < 3) {
        return 0.0;
    }
    weigh_evenly(directions);
    double ideal2 = 0.0;
    double product = 0.0;
    double simulated2 = 0.0;
    for (const SharedDirection& at : directions) {
        ideal2 += at.weight * at.ideal * at.ideal;
        product += at.weight * at.ideal * at.simulated;
        simulated2 += at.weight * at.simulated * at.simulated;
    }
    return std::sqrt(std::max(0.0, simulated2 - product * product / ideal2));
}

std::optional<LateralColourAgreement> lateral_colour_agreement(const PhotographedLens& photographed,
                                                               const ImagedField& simulated) {
    if (!photographed.lateral_colour || simulated.field_angle.size() < 3) {
        return std::nullopt;
    }
    return LateralColourAgreement{
        .red = shift_agreement(photographed, photographed.lateral_colour->red, simulated, 0),
        .blue = shift_agreement(photographed, photographed.lateral_colour->blue, simulated, 2)};
}

}  // namespace lensproof::calibration
