// calibration/measure/measure.h — from pictures to a profile.
#pragma once
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "calibration/geometry/fit_geometry.h"
#include "calibration/measure/known_directions.h"
#include "calibration/profile/profile.h"
#include "engine/formats/image/image.h"
#include "engine/scene/chart/chart.h"

namespace lensproof::calibration {

/// `edges`: what is to be measured is the edges in `MeasureInput::edges`, or whatever edges there are; no chart is
/// looked for. `lines`: what is straight in the scene. `directions`: stars, and whatever else is small, bright, far
/// away and listed in `MeasureInput::directions`.
enum class PictureRole { chart, flat_field, edges, lines, directions };

/// A picture to measure. It is loaded when its turn comes and forgotten after, so a large set needs no large memory.
struct Picture {
    std::string name;
    PictureRole role = PictureRole::chart;
    std::function<formats::Image()> load;            // linear light; may throw InputError
    std::string left_out;                            // why it is not to be used, known beforehand; empty: it is
    std::string remark;                              // what is to be known of it though it is used
    bool use_light = true;                           // whether it may say something of vignetting
    int orientation = 1;                             // EXIF's, for the account
    std::optional<int> jpeg_quality = std::nullopt;  // that it was compressed with, for the self-test
};

/// What charts are asked beside the camera and its distortion. What they are not asked is not looked at.
struct WantedParts {
    bool vignetting = true;
    bool chromatic_shift = true;
    bool sharpness = true;

    friend bool operator==(const WantedParts&, const WantedParts&) = default;
};

/// By "distortion", which is always one of them, "vignetting", "chromatic-shift" and "sharpness".
WantedParts parts_named(const std::vector<std::string>& names);
std::vector<std::string> known_parts();

struct MeasureInput {
    std::string name;  // of the profile
    std::vector<Picture> pictures;
    scene::Chart chart;  // a FlatField when every picture is a flat field
    /// Not set: several models are fitted, and one is chosen (calibration/geometry/model_choice.h).
    std::optional<ModelKind> model;
    GeometryOptions geometry;  // `model` and `disc_diameter_mm` are filled in by `measure`
    ProfileSource source;      // `images` is filled in
    std::optional<double> pixel_pitch_um;
    /// In pictures of the role `edges`: rectangles with one edge each; one without a size is the whole picture. None:
    /// edges are looked for (calibration/sharpness/find_edges.h).
    std::vector<PixelRectangle> edges;
    WantedParts parts;
    int threads = 0;  // 0: one a core; they change nothing but the time
    /// Told, before each picture or behind it, which part of them has been looked at, 0 to 1.
    std::function<void(double)> progress = nullptr;
    /// Where the focus stood in which picture (by name), mm, for field curvature; empty: not known.
    std::map<std::string, double> focus_position_mm;
    KnownDirections directions = {};  // by the picture's name
};

/// Finds the chart, and fits camera model, chromatic shift, vignetting and sharpness.
///
/// Siemens stars, of which a picture may show several, give sharpness alone; edges also the chromatic shift, where they
/// were looked for. Charts that do not tell a camera (one that faces it), where no model was asked for, give what needs
/// none: their distortion about the picture's middle (calibration/geometry/plane_distortion.h), chromatic shift,
/// vignetting and sharpness.
///
/// Straight lines of scenes, which no chart is looked for in, give distortion (calibration/lines/line_distortion.h).
/// Known directions give what charts give of the camera, and the chromatic shift.
///
/// A picture that cannot be loaded, is of another size or other channels than those before it, is the same as one
/// before it, shows no chart, or shows it blurred, is left out; `pictures` in the profile says why. Vignetting comes
/// from the flat fields where there are any, else from the charts' white. Throws InputError for no pictures, where none
/// can be used (with each one's reason), and whatever `fit_geometry` refuses of a model that was asked for, or where
/// nothing else can be measured. Vignetting, chromatic shift and sharpness that fail are not errors; the profile says
/// why.
Profile measure(const MeasureInput& input);

}  // namespace lensproof::calibration
