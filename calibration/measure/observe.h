// calibration/measure/observe.h — from pictures to what is seen in them, the first half of a measurement.
#pragma once
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "calibration/chromatic/chromatic_shift.h"
#include "calibration/detection/line_points.h"
#include "calibration/light/light_samples.h"
#include "calibration/measure/measure.h"
#include "calibration/measure/measure_sharpness.h"
#include "engine/base/input_error.h"

namespace lensproof::calibration {

/// What is kept of the pictures once they are gone.
struct Observations {
    int width = 0;
    int height = 0;
    std::vector<std::string> channels;
    bool grey = true;  // every picture has one channel, or all channels alike
    std::vector<PictureAccount> pictures;
    std::map<std::string, std::string> names_by_pixels;  // the pictures in use, by their pixels' hash
    std::vector<ProfileView> views;
    std::vector<ChartView> chart_views;                                  // of the views found,
    std::vector<std::vector<std::optional<Vec2d>>> point_errors_px;      // their points' standard errors,
    std::vector<std::vector<LinePoints>> lines;                          // and the points of lines
    std::map<std::string, std::vector<ChromaticPair>> chromatic_pairs;   // by channel
    std::map<std::string, std::vector<LightGroup>> flat_fields, whites;  // by channel
    /// By view: the channel that geometry is measured in, and where among its `whites` the view's stands.
    std::map<std::size_t, std::pair<std::string, std::size_t>> reference_whites;
    SharpnessObservations sharpness;
};

/// Loads the pictures one by one and looks for what each is to show. One that does not do is left out, with the reason
/// in its account and, where it should show a chart, in its view; nothing is thrown for it.
Observations observe(const MeasureInput& input);

/// That no picture does, and why each does not.
InputError none_usable(const MeasureInput& input, const Observations& seen);

/// Whether the chart is a Siemens star, which has no points to measure a camera by.
bool shows_star(const MeasureInput& input);

}  // namespace lensproof::calibration
