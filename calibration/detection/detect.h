// calibration/detection/detect.h — finds a chart in a picture, to about a pixel.
#pragma once
#include <string>

#include "calibration/detection/numbering.h"
#include "calibration/detection/refine.h"
#include "engine/formats/image/image.h"
#include "engine/scene/chart/chart.h"

namespace lensproof::calibration {

/// Whether `detect` knows charts of this kind, by what their points look like (engine/scene/chart/chart_traits.h).
bool can_detect(const scene::Chart& chart);

/// The names of those kinds, for messages.
std::string detectable_kinds();

/// What a picture shows of a chart.
struct Detection {
    ChartPoints points;  // to about a pixel; none where the chart was not found
    std::string reason;  // why it was not found, in words ("the picture is too dark"); empty where it was
    Numbering numbering = Numbering::certain;  // which point is which

    [[nodiscard]] bool found() const { return reason.empty(); }
};

/// Looks for `feature_points(chart)`; `points.found` says which of them the picture shows.
///
/// An 8-bit working copy is searched: for checkerboards by OpenCV's detectors, as a whole (where the lens bends the
/// board too much for them, also copies that undo a guessed fisheye projection); for the others by their markers
/// (calibration/detection/detect_charuco.h) or spots (calibration/detection/detect_lattice.h), of which a part will do.
/// Accurate to a pixel or so: `refine` gives the final positions.
///
/// Which point is the first: a ChArUco board's markers say so. On a checkerboard it is the corner whose square is
/// black, as the chart says; where that leaves a choice (a half turn of a board with an even number of columns + rows),
/// and on all other charts, the rows run to the right as far as possible. Mirror images are never taken, where they can
/// be told. A chart needs at least 3 × 3 points. Throws InputError for a chart that cannot be detected, or has too few
/// points.
Detection detect(const formats::Image& image, const scene::Chart& chart);

}  // namespace lensproof::calibration
