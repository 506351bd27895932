// calibration/photos/picture_quality.h — whether a picture is sharp and well exposed, in words.
#pragma once
#include <string>

#include "calibration/detection/refine.h"
#include "engine/io/image.h"
#include "engine/scene/chart.h"

namespace lensproof {

/// Between the tones of neighbouring fields of a chart that was found.
struct ChartQuality {
    double edge_width_px = 0.0;        // from 10 % to 90 % of the step, the median over the chart
    double edge_width_share = 0.0;     // of the distance between neighbouring points
    double clipped_white_share = 0.0;  // edges whose bright side is at full scale
};

/// Checkerboards and disc grids in one channel; all 0 for other charts, and where no edge could be judged.
ChartQuality chart_quality(const Image& image, int channel, const ChartPoints& points, const Chart& chart);

/// Why a chart that was found had better be left out: its edges are a quarter of its fields wide, so that neighbours'
/// blurs meet in a corner's window. Empty where there is no such reason.
std::string too_blurred(const ChartQuality& quality);

/// What is wrong with a picture that showed no chart: over-exposed, under-exposed or blurred all over; empty where
/// nothing of that is seen.
std::string visible_fault(const Image& image, int channel);

}  // namespace lensproof
