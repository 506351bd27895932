// calibration/statistics/curve.h — a measured quantity over the image height, with its 95 % band.
#pragma once
#include <optional>
#include <string>
#include <vector>

namespace lensproof::calibration {

/// Samples at image heights (distance from the principal point over the picture's half-diagonal, no unit).
struct Curve {
    std::vector<double> image_height;  // ascending from 0
    std::vector<double> value;
    std::vector<double> lower_95;
    std::vector<double> upper_95;
    /// Measurements reach this far; samples beyond it are the model's extrapolation.
    double covered_image_height = 0.0;

    friend bool operator==(const Curve&, const Curve&) = default;
};

/// A value with its 95 % bounds.
struct Banded {
    double value = 0.0;
    double lower_95 = 0.0;
    double upper_95 = 0.0;
};

/// Half the width of a 95 % interval, in standard errors of a normal distribution.
constexpr double k95 = 1.959963984540054;

/// The image heights that curves are sampled at: 0, 1/40, …, 1.
std::vector<double> standard_image_heights();

void append(Curve& curve, double image_height, const Banded& sample);

/// A sample that has no error, up to which the curve is covered then.
void append_exact(Curve& curve, double image_height, double value);

/// The curve at `image_height`, linear between samples; none outside them.
std::optional<Banded> sample(const Curve& curve, double image_height);

}  // namespace lensproof::calibration
