// calibration/measure/measure_sharpness.h — from pictures' edges to the sharpness in a profile.
#pragma once
#include <map>
#include <string>
#include <vector>

#include "calibration/chromatic/chromatic_shift.h"
#include "calibration/detection/refine.h"
#include "calibration/profile/profile.h"
#include "calibration/sharpness/profile_edge.h"
#include "calibration/sharpness/profile_star.h"
#include "engine/formats/image/image.h"
#include "engine/scene/chart/chart.h"

namespace lensproof::calibration {

/// The edges seen so far.
struct SharpnessObservations {
    std::map<std::string, std::vector<ProfileEdge>> edges;  // by channel
    std::map<std::string, std::vector<ProfileStar>> stars;  // by channel
    std::map<std::string, int> refusals;                    // how many edges were refused for which reason
    int coloured_edges = 0;                                 // found in pictures: between two colours
    /// Where the focus stood, mm, by picture; empty when that is not known.
    std::map<std::string, double> focus_position_mm;
};

/// Measures the chart's edges (`chart_edges`) in one channel of a picture.
void observe_chart_edges(SharpnessObservations& seen, const formats::Image& image, int channel, const std::string& name,
                         const ChartPoints& points, const scene::Chart& chart);

/// Measures what edges there are, in all `channels`, and lists those that can be measured. Returns by channel the pairs
/// with `reference`, each known along its edge's normal: of edges between tones of one colour, since a coloured thing's
/// edge may lie elsewhere in each channel by itself. Throws InputError saying why there is none.
std::map<std::string, std::vector<ChromaticPair>> observe_any_edges(SharpnessObservations& seen,
                                                                    const formats::Image& image,
                                                                    const std::vector<int>& channels, int reference,
                                                                    const std::string& name);

/// Measures the one edge in each rectangle in one channel; one without width and height is the whole picture.
/// Throws InputError naming the picture, the rectangle and why its edge cannot be measured.
void observe_edges(SharpnessObservations& seen, const formats::Image& image, int channel, const std::string& name,
                   const std::vector<PixelRectangle>& rectangles);

/// Measures the Siemens stars in one channel. Throws InputError saying why there is none that can be measured.
void observe_stars(SharpnessObservations& seen, const formats::Image& image, int channel, const std::string& name,
                   const scene::SiemensStar& star);

/// Adds to the profile: the stars; the edges; of each channel with enough edges the curves of MTF50 in cycles per pixel
/// (per mm too where the pixel pitch is known) and their ratio; with focus positions also those of the best focus. The
/// field is that of the pictures in `seen` together; of a focus series, that of the position at which the edges are
/// sharpest. Whole MTF curves are kept of channels with at most 200 edges.
void add_sharpness(Profile& profile, const SharpnessObservations& seen, const Vec2d& centre_px);

}  // namespace lensproof::calibration
