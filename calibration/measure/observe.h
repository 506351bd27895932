// calibration/measure/observe.h — from pictures to what is seen in them, the first half of a measurement.
#pragma once
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "calibration/chromatic/chromatic_shift.h"
#include "calibration/detection/line_points.h"
#include "calibration/light/light_samples.h"
#include "calibration/lines/scene_line.h"
#include "calibration/measure/measure.h"
#include "calibration/measure/measure_sharpness.h"
#include "engine/base/input_error.h"

namespace lensproof::calibration {

/// What is kept of a picture once it is gone.
struct PictureObservation {
    PictureAccount account;
    std::string pixels_hash;                            // empty where it could not be loaded
    std::optional<ProfileView> view;                    // where a chart or directions were looked for; if found:
    ChartView points;                                   // the features seen,
    std::vector<std::optional<Vec2d>> point_errors_px;  // their standard errors,
    std::vector<LinePoints> lines;                      // the points of lines,
    std::vector<SceneLine> scene_lines;                 // where lines of the scene were looked for,
    std::string reference_channel;                      // the channel that geometry is measured in,
    std::map<std::string, std::vector<ChromaticPair>> chromatic_pairs;  // and by channel where it shows them
    std::map<std::string, LightGroup> light;  // by channel, of the chart's white or of a flat field

    [[nodiscard]] bool shows_chart() const { return view && view->found; }
};

struct Observations {
    int width = 0;
    int height = 0;
    std::vector<std::string> channels;
    bool grey = true;  // every picture has one channel, or all channels alike
    std::vector<PictureObservation> pictures;
    SharpnessObservations sharpness;
};

/// Loads the pictures, as many at once as threads and memory allow, and looks for what each is to show. One that does
/// not do is left out, with the reason in its account and, where it should show a chart, in its view; nothing is thrown
/// for it.
Observations observe(const MeasureInput& input);

/// That no picture does, and why each does not.
InputError none_usable(const MeasureInput& input, const Observations& seen);

/// Whether a chart was looked for in any picture.
bool looks_for_charts(const Observations& seen);

/// Whether any picture has that role.
bool has_role(const MeasureInput& input, PictureRole role);

/// Whether the chart is a Siemens star, which has no points to measure a camera by.
bool shows_star(const MeasureInput& input);

}  // namespace lensproof::calibration
