// calibration/measure.h — from pictures to a profile.
#pragma once
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "calibration/fit_geometry.h"
#include "calibration/profile.h"
#include "engine/io/image.h"
#include "engine/scene/chart.h"

namespace lensproof {

enum class PictureRole { chart, flat_field };

/// A picture to measure. It is loaded when its turn comes and forgotten after, so a large set needs no large memory.
struct Picture {
    std::string name;
    PictureRole role = PictureRole::chart;
    std::function<Image()> load;  // linear light; may throw InputError
};

struct MeasureInput {
    std::string name;  // of the profile
    std::vector<Picture> pictures;
    Chart chart;  // a FlatField when every picture is a flat field
    /// Not set: several models are fitted, and one is chosen (calibration/model_choice.h).
    std::optional<ModelKind> model;
    GeometryOptions geometry;  // `model` and `disc_diameter_mm` are filled in by `measure`
    ProfileSource source;      // `images` is filled in
    std::optional<double> pixel_pitch_um;
};

/// Finds the chart, and fits camera model, chromatic shift and vignetting.
///
/// Pictures in which the chart, or most of it, cannot be found are listed as such. Vignetting comes from the flat
/// fields where there are any, else from the charts' white.
/// Throws InputError for no pictures, pictures of different sizes or channels, no chart found in any, and whatever
/// `fit_geometry` refuses. Vignetting and chromatic shift that fail are not errors; the profile says why.
Profile measure(const MeasureInput& input);

}  // namespace lensproof
