// calibration/sharpness/slanted_edge.h — the modulation transfer function across one slanted edge, with its errors.
#pragma once
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "engine/base/vec.h"
#include "engine/formats/image/image.h"

namespace lensproof::calibration {

/// The part of a picture on both sides of one straight, or gently bent, edge: a rectangle that lies along it.
struct EdgeRegion {
    Vec2d centre_px;  // on the edge, to a few pixels
    Vec2d along;      // unit vector along the edge, to a degree or two
    double half_length_px = 0.0;
    double half_width_px = 0.0;  // on either side; nothing but the edge's two tones in there
};

/// A frequency at which the MTF has fallen to some level.
struct MtfFrequency {
    double cycles_per_px = 0.0;
    double standard_error = 0.0;
    double lower_95 = 0.0;  // Student's t: the error comes from a limited number of segments of the edge
    double upper_95 = 0.0;
};

/// What one edge says about sharpness in the direction of its normal. Frequencies count along that normal, cycles per
/// pixel; half a cycle per pixel is the Nyquist frequency of rows and columns, and what passes beyond it is aliased in
/// a picture, though not here.
struct EdgeMtf {
    Vec2d centre_px;          // on the edge
    double normal_deg = 0.0;  // direction from dark to bright, from +x towards +y, in (-180, 180]
    double rise_px = 0.0;     // from 10 % to 90 %
    double bend_px = 0.0;     // largest distance of the edge from a straight line
    double length_px = 0.0;   // of the part that was measured, along the edge,
    double width_px = 0.0;    // and across it
    std::vector<double> mtf;  // at 0, kMtfStep, 2 kMtfStep, … 1 cycle per pixel
    std::vector<double> mtf_standard_error;
    std::optional<MtfFrequency> mtf50;  // none: not below 1 cycle per pixel
    std::optional<MtfFrequency> mtf10;
};

constexpr double kMtfStep = 0.02;  // cycles per pixel

/// Why an edge was not measured, as a phrase.
struct EdgeRefusal {
    std::string reason;
};

/// The edge-based spatial frequency response of ISO 12233 (2017, annex D; Burns, "Slanted-edge MTF for digital camera
/// and scanner analysis", 2000), in one channel of linear light:
///
/// 1. The edge's place: a cubic along the edge (distortion bends it), by least squares of all pixels against the common
///    edge profile. Nothing depends on rows or columns, so the edge may run in any direction, except along them.
/// 2. Uneven light: a gradient common to both sides is divided out.
/// 3. The edge-spread function: means over bins of a quarter of a pixel of distance from the edge (wider ones where a
///    short edge would leave bins empty), each moved to its bin's middle along the local slope.
/// 4. Its differences, under a window that is flat over 2.5 rises on either side and then falls to 0 as a cosine, are
///    Fourier transformed. The box of a bin and that of the difference each cost sin(π f Δ)/(π f Δ): divided out.
/// 5. Noise in quadrature to the signal raises a modulus; its variance is taken off.
///
/// Errors: every step after the first is linear in the pixels to first order. The influence of each pixel times its
/// residual, summed over 8 to 24 segments of the edge, gives the variance (the sandwich estimator with clusters, Liang
/// & Zeger 1986). So noise that grows with the signal, that demosaicking or JPEG has correlated over a few pixels, or a
/// ragged print, widens the interval as it should. What lies beyond the window (veiling glare) is not part of the MTF.
///
/// Refused: regions with clipped pixels (exactly 1 on the bright side or cut noise at 0 on the dark one), without
/// contrast, too short, too narrow for their blur, or along pixel rows, columns or diagonals.
std::variant<EdgeMtf, EdgeRefusal> measure_edge(const formats::Image& image, int channel, const EdgeRegion& region);

/// A rectangle of pixels, from its top left one.
struct PixelRectangle {
    int x = 0;
    int y = 0;
    int width = 0;
    int height = 0;
};

/// The region along the one edge in a rectangle, from the principal axis of its brightness gradients.
std::variant<EdgeRegion, EdgeRefusal> find_edge(const formats::Image& image, int channel,
                                                const PixelRectangle& rectangle);

}  // namespace lensproof::calibration
