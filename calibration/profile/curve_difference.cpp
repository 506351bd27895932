#include "calibration/profile/curve_difference.h"

#include <algorithm>
#include <cmath>

namespace lensproof::calibration {

namespace {

/// One standard error of a banded sample.
double sigma_of(const Banded& sample) {
    return (sample.upper_95 - sample.lower_95) / (2.0 * k95);
}

void summarise(CurveDifference& difference) {
    double weight = 0.0;
    double squares = 0.0;
    double variance = 0.0;
    const Curve& curve = difference.curve;
    for (std::size_t i = 0; i < curve.value.size(); ++i) {
        const double x = curve.image_height[i];
        const double sigma = sigma_of({curve.value[i], curve.lower_95[i], curve.upper_95[i]});
        weight += x;
        squares += x * curve.value[i] * curve.value[i];
        variance += x * sigma * sigma;
        if (std::abs(curve.value[i]) >= difference.largest) {
            difference.largest = std::abs(curve.value[i]);
            difference.largest_sigma = sigma;
            difference.largest_at = x;
        }
    }
    difference.rms = std::sqrt(squares / weight);
    difference.rms_sigma = std::sqrt(variance / weight);
}

}  // namespace

std::optional<CurveDifference> difference(const Curve& a, const Curve& b) {
    const double covered = std::min(a.covered_image_height, b.covered_image_height);
    CurveDifference result;
    for (const double x : standard_image_heights()) {
        const std::optional<Banded> from_a = sample(a, x);
        const std::optional<Banded> from_b = sample(b, x);
        if (x > covered || !from_a || !from_b) {
            break;
        }
        const double value = from_a->value - from_b->value;
        const double half_band = k95 * std::hypot(sigma_of(*from_a), sigma_of(*from_b));
        append(result.curve, x, {.value = value, .lower_95 = value - half_band, .upper_95 = value + half_band});
        result.curve.covered_image_height = x;
    }
    if (!(result.curve.covered_image_height > 0.0)) {
        return std::nullopt;
    }
    summarise(result);
    return result;
}

std::optional<CurveDifference> difference(const Profile& a, const Profile& b, const std::string& curve) {
    if (curve == kQuantities.image_position.key()) {
        return radial_difference_px(a, b);
    }
    const Curve* in_a = find_curve(a, curve);
    const Curve* in_b = find_curve(b, curve);
    return in_a != nullptr && in_b != nullptr ? difference(*in_a, *in_b) : std::nullopt;
}

std::optional<CurveDifference> radial_difference_px(const Profile& a, const Profile& b) {
    const std::string angle = kQuantities.field_angle.key();
    std::optional<CurveDifference> angles = difference(a, b, angle);
    if (!angles) {
        return std::nullopt;
    }
    const Curve& reference = b.curves.at(angle);
    const std::vector<double>& heights = angles->curve.image_height;
    CurveDifference radii;
    for (std::size_t i = 0; i < heights.size(); ++i) {
        const double from = heights[i == 0 ? 0 : i - 1];
        const double to = heights[std::min(i + 1, heights.size() - 1)];
        const double px_per_deg =
            half_diagonal_px(b) * (to - from) / (sample(reference, to)->value - sample(reference, from)->value);
        append(radii.curve, angles->curve.image_height[i],
               {.value = -px_per_deg * angles->curve.value[i],
                .lower_95 = -px_per_deg * angles->curve.upper_95[i],
                .upper_95 = -px_per_deg * angles->curve.lower_95[i]});
    }
    radii.curve.covered_image_height = angles->curve.covered_image_height;
    summarise(radii);
    return radii;
}

}  // namespace lensproof::calibration
