// calibration/light/vignetting_models.h — vignetting as formulas that other programs use, and as a coarse map.
#pragma once
#include <array>
#include <string>
#include <vector>

#include "calibration/light/light_samples.h"
#include "calibration/light/vignetting.h"

namespace lensproof::calibration {

/// One formula fitted to the light of a picture; r is the image height (the corner at 1).
struct VignettingModel {
    /// "cos4":       V = 1 / (1 + k r²)², k = (half-diagonal / focal length)²: an ideal lens without vignetting;
    /// "pa":         V = 1 + a1 r² + a2 r⁴ + a3 r⁶ (lensfun's);
    /// "kang-weiss": V = (1 − α r) / (1 + k r²)² · (1 + t_x x + t_y y)³, x and y in half-diagonals: off-axis light,
    ///               vignetting and the tilt of the lit surface (Kang & Weiss 2000, "Can we calibrate a camera using an
    ///               image of a flat, textureless Lambertian surface?", eq. 9);
    /// "spline":     the curve of calibration/light/vignetting.h.
    std::string name;
    std::vector<std::string> parameter_names;  // none of the spline, which is listed for comparison only
    std::vector<double> values;
    std::vector<double> covariance;  // row by row
    double relative_rms = 0.0;       // of the samples about the model
    double aicc = 0.0;               // for comparison: it knows no blocks
    /// Of the samples in blocks of the picture that were left out of the fit, weighted by their sigmas. 0 in profiles
    /// from before it was measured.
    double held_out_relative_rms = 0.0;
    std::string verdict;  // why it was chosen, or why not, in words
};

/// V of a model at (x, y) half-diagonals from the optical centre.
double relative_illumination(const VignettingModel& model, const Vec2d& at);

/// Fits each formula and a gain to the samples that the spline used (its gains and gradients of the light taken out),
/// in the logarithm, by Gauss-Newton; the spline is among them. The chosen one comes first, the others by what they
/// predict: each of five fits leaves out a fifth of the picture's 11 × 11 blocks and predicts them (whole blocks,
/// because a smudge or a shadow that neighbours share is no help to a sample that is left out alone). The model with
/// the fewest terms wins of those that predict as well as the best, give or take one standard error of the difference
/// between blocks. A formula that the samples do not determine is left out; empty when they determine none.
std::vector<VignettingModel> fit_vignetting_models(const Vignetting& vignetting);

/// Means of V over 11 × 11 cells of the picture, row by row from the top left. A cell without samples has `samples` 0.
struct ShadingGrid {
    static constexpr int kSide = 11;
    struct Cell {
        double mean = 0.0;
        double standard_error = 0.0;  // from the samples' scatter; from their own errors where there is but one
        int samples = 0;
    };
    std::array<Cell, static_cast<std::size_t>(kSide) * kSide> cells;
};

ShadingGrid shading_grid(const Vignetting& vignetting, int width_px, int height_px);

}  // namespace lensproof::calibration
