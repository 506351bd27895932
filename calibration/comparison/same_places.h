// calibration/comparison/same_places.h — what two registered pictures show at the same places: edges' sharpness, and
// patches of light.
#pragma once
#include <string>
#include <vector>

#include "calibration/comparison/exposure_match.h"
#include "calibration/comparison/light_spot.h"
#include "calibration/comparison/overlap.h"
#include "calibration/comparison/registration.h"
#include "calibration/sharpness/slanted_edge.h"
#include "engine/formats/image/image.h"

namespace lensproof::calibration {

/// An edge as each picture shows it. Frequencies of both are in cycles per pixel of a.
struct EdgePair {
    EdgeMtf a;
    EdgeMtf b;
};

struct SharpnessComparison {
    std::string channel;
    std::vector<EdgePair> pairs;
    int refused = 0;  // edges that one of the pictures does not show well enough
    /// The means over the edges, at 0, kMtfStep, 2 kMtfStep, … 1 cycle per pixel of a.
    std::vector<double> mtf_a;
    std::vector<double> mtf_b;
    std::vector<Estimate> difference;  // b less a; errors from the edges' scatter, or where it is less from their own
    Estimate mtf50_ratio;              // b over a: the geometric mean over the edges that have both
};

/// At the edges in `rectangles` of a, or where there are none at those found in it (find_edges.h). Each picture is
/// measured in its own pixels, so that b is not smoothed by what brings it over a. In green, or the one channel of
/// grey. Throws InputError where no edge is to be measured in both.
SharpnessComparison compare_sharpness(const formats::Image& a, const formats::Image& b,
                                      const Registration& registration, const std::vector<PixelRectangle>& rectangles);

/// A patch of light in a box of a, and in b where the registration has it.
struct SpotPair {
    PixelRectangle box;  // in a
    LightSpot a;
    LightSpot b;
    Estimate shift_x_px;  // of the centroid in b from where a's would be there, b's pixels
    Estimate shift_y_px;
    Estimate diameter_ratio;          // b over a, the registration's enlargement taken out
    Estimate light_ev;                // likewise, in b's matched exposure; of all channels together
    std::vector<Estimate> colour_ev;  // of each channel over green, b less a; green is 0; empty in grey
};
SpotPair compare_spots(const formats::Image& a, const formats::Image& b, const Registration& registration,
                       const ExposureMatch& exposure, const ClippedFrom& clipped, const PixelRectangle& box);

}  // namespace lensproof::calibration
