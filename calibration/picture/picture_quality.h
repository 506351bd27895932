// calibration/picture/picture_quality.h — whether a picture is sharp and well exposed, in words.
#pragma once
#include <string>

#include "calibration/detection/refine.h"
#include "calibration/picture/picture_traits.h"
#include "engine/formats/image/image.h"
#include "engine/scene/chart/chart.h"

namespace lensproof::calibration {

/// Why a chart that was found had better be left out: its edges (from 10 % to 90 %) are a quarter of its fields wide,
/// so that neighbours' blurs meet in a corner's window. Empty where there is no such reason, and for charts without
/// white fields.
std::string too_blurred(const PictureTraits& traits, const ChartPoints& points, const scene::Chart& chart);

/// Whether the white around most of the chart's points is at full scale.
bool is_white_clipped(const PictureTraits& traits);

/// What is wrong with a picture that showed no chart: over-exposed, under-exposed or blurred all over; empty where
/// nothing of that is seen.
std::string visible_fault(const formats::Image& image, int channel);

}  // namespace lensproof::calibration
