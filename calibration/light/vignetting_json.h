// calibration/light/vignetting_json.h — vignetting's formulas and shading grids in a profile's JSON.
#pragma once
#include "calibration/light/vignetting_models.h"
#include "engine/base/json_archive.h"

namespace lensproof::calibration {

/// `name`, `parameters` (each `value` and `standard_error`), `covariance` (row by row), `relative_rms`,
/// `held_out_relative_rms`, `aicc`, `verdict` (why it was chosen, or why not, in words).
void fields(JsonArchive& json, VignettingModel& model);

/// `columns`, `rows` (both 11), and row by row from the top left `mean`, `standard_error` and `samples`; where there
/// are no samples, all three are 0.
void fields(JsonArchive& json, ShadingGrid& grid);

}  // namespace lensproof::calibration
