// calibration/sharpness/find_edges.h — the edges of any picture that can be measured, without knowing what it shows.
#pragma once
#include <vector>

#include "calibration/sharpness/slanted_edge.h"

namespace lensproof::calibration {

/// Straight stretches between two even tones, each as wide as its tones are even: squares of a chart, a window's frame,
/// a roof. Lines of the picture's brightness (von Gioi, Jakubowicz, Morel & Randall 2012, through OpenCV), cut into
/// stretches of at most 96 px; of each part of the frame the best by contrast and length, at most 600 in all, row by
/// row of the parts.
///
/// What the edge is of is not known: that of a round pillar, or of a thing out of focus, is blurred by itself, and
/// lowers what is measured.
std::vector<EdgeRegion> find_edges(const formats::Image& image, int channel);

/// (bright − dark) / (bright + dark) of the region's two tones in a channel, signed by the side that is brighter; alike
/// in all channels where both sides have one colour.
double tone_contrast(const formats::Image& image, int channel, const EdgeRegion& region);

}  // namespace lensproof::calibration
