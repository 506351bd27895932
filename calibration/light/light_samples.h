// calibration/light/light_samples.h — where a picture shows an even tone, and how bright.
#pragma once
#include <vector>

#include "calibration/detection/refine.h"
#include "engine/formats/image/image.h"
#include "engine/scene/chart/chart.h"

namespace lensproof::calibration {

/// The mean of a patch of pixels.
struct LightSample {
    Vec2d pixel_px;  // middle of the patch
    double value = 0.0;
    double relative_error = 0.0;  // standard error of the mean over the mean
    Vec2d chart_mm;               // where on the chart; (0, 0) in a flat field
};

/// Samples under one light and exposure: a flat field, or the white of one view of a chart.
struct LightGroup {
    bool on_chart = false;
    std::vector<LightSample> samples;
};

/// A flat field as means over square cells, about 48 along the longer side.
///
/// Left out: cells below 2 % of the bright ones (the 95th percentile), which lie outside the image circle, and those
/// within two cells of them, which may straddle its edge; cells that touch clipped pixels (exactly full scale, 1, where
/// more than 1 % of the picture is); cells where fewer than half the pixels are finite. May be empty.
LightGroup flat_field_samples(const formats::Image& image, int channel);

/// The white between a chart's found points: the inner 60 % of white squares, or patches between four discs.
/// Same rule for clipped pixels. May be empty (a disc grid without room between the discs, other kinds of chart).
LightGroup chart_white_samples(const formats::Image& image, int channel, const ChartPoints& points,
                               const scene::Chart& chart);

}  // namespace lensproof::calibration
