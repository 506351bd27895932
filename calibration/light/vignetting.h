// calibration/light/vignetting.h — how much light reaches the picture's edge, relative to its axis.
#pragma once
#include <array>
#include <vector>

#include "calibration/light/light_samples.h"
#include "calibration/statistics/curve.h"

namespace lensproof::calibration {

/// A sample as the fit used it: the light relative to the axis, its group's gain and gradient taken out.
struct ShadingSample {
    Vec2d pixel_px;
    Vec2d at;  // from the centre, in half-diagonals
    double log_ratio = 0.0;
    double sigma = 0.0;  // of log_ratio, up to a common factor that the residuals tell
};

/// Relative illumination V of one channel against the image height, V = 1 on the axis. It is what a picture of an
/// even tone shows: what the rims cut, cos⁴, and whatever the sensor adds, together.
struct Vignetting {
    Curve ratio;                       // V
    Curve ev;                          // log2 V
    int spans = 0;                     // of the spline
    double effective_terms = 0.0;      // that the data left of them (statistics/smoothed_fit.h)
    std::vector<double> coefficients;  // of the spline of ln V, from the axis outwards
    std::vector<double> covariance;    // theirs, row by row
    int samples_used = 0;
    double relative_rms = 0.0;  // of the samples about the fit
    std::vector<ShadingSample> samples;
    double chi_squared = 0.0;  // of the samples about the fit
    int gain_terms = 0;        // columns of the fit that were gains and gradients
};

/// Fits ln(value) = ln(gain of the group) + s(r) + (on charts) b_x X + b_y Y.
///
/// s is a uniform cubic B-spline over r from the axis to the farthest sample, mirrored at r = 0 (V is even and smooth)
/// and s(0) = 0, of as many spans, 1 to 24, as the samples determine, so that a flat field can follow vignetting that
/// sets in suddenly, where a polynomial in r² of three terms is wrong by a percent. The samples say how smooth it is
/// (statistics/smoothed_fit.h, third differences): few samples on charts leave a stiff curve, a parabola at last. No
/// number of spans is chosen by the residuals, because what such a choice scatters is in no band: chosen by the least
/// AICc, curves scattered a fifth more than their bands said. The gradient (b_x, b_y) allows for a lamp at one side of
/// a chart.
///
/// In the logarithm all is linear; samples beyond 5 robust standard deviations are left out, and the two kinds of
/// groups are weighted by their own residuals. Bands cover the statistical error; they know nothing of flat fields that
/// were not flat, nor of how a kink is rounded off within a span or two of it.
///
/// Throws InputError when there are too few samples (fewer than 12) or they all lie at one radius.
Vignetting fit_vignetting(const std::vector<LightGroup>& groups, const Vec2d& centre_px, double half_diagonal_px);

/// The polynomial V = 1 + a1 r² + a2 r⁴ + a3 r⁶ closest to a measured ratio over the covered heights (lensfun's "pa").
struct PolynomialVignetting {
    std::array<double, 3> a{};
    double largest_error = 0.0;  // in V
};
PolynomialVignetting polynomial_vignetting(const Curve& ratio);

}  // namespace lensproof::calibration
