// calibration/photographed/lens_agreement.h — how far a simulated lens is from the photographed one.
#pragma once
#include <array>
#include <optional>
#include <vector>

#include "calibration/photographed/imaged_field.h"
#include "calibration/photographed/photographed_lens.h"

namespace lensproof::calibration {

/// The difference of two curves over the image height, evenly over it.
struct Residual {
    double rms_um = 0.0;
    double largest_um = 0.0;
};

/// A height as a fraction of the half-diagonal, and a value there.
using CurvePoint = std::array<double, 2>;

/// A photographed lens against a simulated one where both image directions: photographed at r_d(F g(θ)), simulated at
/// h(θ), green's. F is fitted, the one free scale, by least squares evenly over h from the axis to `reach`.
struct DistortionAgreement {
    Residual residual;
    double scale = 0.0;  // the photographed lens's focal length on the axis, F r_d'(0), over the simulated one's
    double reach = 0.0;  // the height, as a fraction of the half-diagonal, up to which both image
    /// 100 (r / (f g(θ)) − 1) with the simulated focal length f: the curves lie upon each other where the lenses agree,
    /// and the photographed one starts at 100 (scale − 1).
    std::vector<CurvePoint> photographed_percent{};
    std::vector<CurvePoint> simulated_percent{};
};

/// Nothing where the entry has no distortion, no ray arrives near the axis, or less than a tenth of the half-diagonal
/// is imaged by both.
std::optional<DistortionAgreement> distortion_agreement(const PhotographedLens& photographed,
                                                        const ImagedField& simulated);

/// Root mean square (mm) of what distinguishes the simulated lens from one of that projection without distortion of the
/// best focal length, evenly over image heights up to `edge_mm`: departure_from_ideal's other side.
double departure_from_ideal(const ImagedField& simulated, optics::Projection projection, double edge_mm);

/// One channel's image outside of green's, µm, over the height of green's.
struct ShiftAgreement {
    Residual residual;
    std::vector<CurvePoint> photographed_um{};
    std::vector<CurvePoint> simulated_um{};
};

struct LateralColourAgreement {
    ShiftAgreement red;
    ShiftAgreement blue;
};

/// With no scale free. Nothing where the entry has no lateral colour.
std::optional<LateralColourAgreement> lateral_colour_agreement(const PhotographedLens& photographed,
                                                               const ImagedField& simulated);

}  // namespace lensproof::calibration
