#include "calibration/photographed/photographed_lens.h"

#include <algorithm>
#include <cmath>

#include "engine/base/bisect.h"
#include "engine/formats/image/full_frame.h"

namespace lensproof::calibration {

namespace {

constexpr int kHeights = 200;

/// In the polynomial's unit.
double radius_of(const RadialPolynomial& polynomial, double r) {
    double sum = 0.0;
    for (std::size_t i = polynomial.size(); i-- > 0;) {
        sum = (sum + polynomial[i]) * r;
    }
    return sum;
}

}  // namespace

double MeasuredVignetting::brightness(double fraction) const {
    const double x2 = fraction * fraction;
    double sum = 0.0;
    for (std::size_t i = k.size(); i-- > 0;) {
        sum = (sum + k[i]) * x2;
    }
    return corrects ? 1.0 / (1.0 + sum) : 1.0 + sum;
}

double PhotographedLens::half_diagonal_mm() const {
    return 0.5 * formats::kFullFrameDiagonal_mm / crop_factor;
}

double PhotographedLens::unit_mm() const {
    return half_diagonal_mm() / std::hypot(1.0, aspect_ratio);
}

double photographed_radius(const PhotographedLens& lens, double ideal_mm) {
    return radius_of(lens.distortion, ideal_mm / lens.unit_mm()) * lens.unit_mm();
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

std::optional<double> ideal_radius(const PhotographedLens& lens, double radius_mm) {
    const double covered = ideal_radius_covered(lens, 4.0 * lens.half_diagonal_mm());
    if (photographed_radius(lens, covered) < radius_mm) {
        return std::nullopt;
    }
    constexpr int kHalvings = 60;
    return bisected({.inside = 0.0, .outside = covered}, kHalvings,
                    [&](double ideal_mm) { return photographed_radius(lens, ideal_mm) <= radius_mm; })
        .inside;
}

double channel_shift(const PhotographedLens& lens, const ChannelRadius& channel, double radius_mm) {
    if (const auto* scale = std::get_if<ChannelScale>(&channel)) {
        const double r = radius_mm / lens.unit_mm();
        return radius_mm * (scale->v - 1.0 + r * (scale->c + r * scale->b));
    }
    const double ideal_mm =
        ideal_radius(lens, radius_mm).value_or(ideal_radius_covered(lens, 4.0 * lens.half_diagonal_mm()));
    return radius_of(std::get<RadialPolynomial>(channel), ideal_mm / lens.unit_mm()) * lens.unit_mm() -
           photographed_radius(lens, ideal_mm);
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
