// calibration/light/vignetting_json.h — vignetting's formulas and shading grids in a profile's JSON.
#pragma once
#include <vector>

#include "calibration/light/vignetting_models.h"
#include "engine/base/json_node.h"

namespace lensproof::calibration {

/// A list, the chosen formula first: `name`, `parameters` (each `value` and `standard_error`), `covariance` (row by
/// row), `relative_rms`, `held_out_relative_rms`, `aicc`, `verdict` (why it was chosen, or why not, in words).
Json to_json(const std::vector<VignettingModel>& models);
std::vector<VignettingModel> parse_vignetting_models(const JsonNode& node);

/// `columns`, `rows` (both 11), and row by row from the top left `mean`, `standard_error` and `samples`; where there
/// are no samples, all three are 0.
Json to_json(const ShadingGrid& grid);
ShadingGrid parse_shading_grid(const JsonNode& node);

// Reading throws InputError as JsonNode says.

}  // namespace lensproof::calibration
