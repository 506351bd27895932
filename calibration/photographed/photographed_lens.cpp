#include "calibration/photographed/photographed_lens.h"

#include <algorithm>
#include <cmath>

namespace lensproof::calibration {

namespace {

const double kFullFrameDiagonal_mm = std::hypot(36.0, 24.0);
constexpr int kHeights = 200;

}  // namespace

double MeasuredVignetting::brightness(double share) const {
    const double x2 = share * share;
    return 1.0 + x2 * (k[0] + x2 * (k[1] + x2 * k[2]));
}

double PhotographedLens::half_diagonal_mm() const {
    return 0.5 * kFullFrameDiagonal_mm / crop_factor;
}

double PhotographedLens::unit_mm() const {
    return half_diagonal_mm() / std::hypot(1.0, aspect_ratio);
}

double photographed_radius(const PhotographedLens& lens, double ideal_mm) {
    const double u = ideal_mm / lens.unit_mm();
    double sum = 0.0;
    for (std::size_t i = lens.distortion.size(); i-- > 0;) {
        sum = (sum + lens.distortion[i]) * u;
    }
    return sum * lens.unit_mm();
}

double photographed_slope(const PhotographedLens& lens, double ideal_mm) {
    const double u = ideal_mm / lens.unit_mm();
    double sum = 0.0;
    for (std::size_t i = lens.distortion.size(); i-- > 0;) {
        sum = sum * u + static_cast<double>(i + 1) * lens.distortion[i];
    }
    return sum;
}

double ideal_radius_covered(const PhotographedLens& lens, double largest_mm) {
    constexpr int kSteps = 1000;
    double covered = 0.0;
    for (int i = 1; i <= kSteps; ++i) {
        const double radius = largest_mm * i / kSteps;
        if (!(photographed_slope(lens, radius) > 0.0)) {
            break;
        }
        covered = radius;
    }
    return covered;
}

double channel_shift(const PhotographedLens& lens, const ChannelScale& channel, double radius_mm) {
    const double r = radius_mm / lens.unit_mm();
    return radius_mm * (channel.v - 1.0 + r * (channel.c + r * channel.b));
}

double departure_from_ideal(const PhotographedLens& lens) {
    // Least squares of r_d − k r_u over r_d: sums over r_u with the weight dr_d.
    const double largest = ideal_radius_covered(lens, 4.0 * lens.half_diagonal_mm());
    double uu = 0.0;
    double ud = 0.0;
    double dd = 0.0;
    double total = 0.0;
    const double edge = lens.half_diagonal_mm();
    for (int i = 0; i < 4 * kHeights; ++i) {
        const double u = largest * (i + 0.5) / (4 * kHeights);
        const double d = photographed_radius(lens, u);
        if (d > edge) {
            break;
        }
        const double weight = photographed_slope(lens, u);
        uu += weight * u * u;
        ud += weight * u * d;
        dd += weight * d * d;
        total += weight;
    }
    return total > 0.0 ? std::sqrt(std::max(0.0, (dd - ud * ud / uu) / total)) : 0.0;
}

}  // namespace lensproof::calibration
