// calibration/geometry/geometry_json.h — a profile's board shape, projection uncertainty and model choice as JSON.
#pragma once

#include "calibration/geometry/board_shape.h"
#include "calibration/geometry/model_choice.h"
#include "calibration/geometry/projection_uncertainty.h"
#include "engine/base/json_node.h"

namespace lensproof::calibration {

Json to_json(const BoardShape& board);
Json to_json(const UncertaintyMap& map);
Json to_json(const ModelChoice& choice);

// Each reads what `to_json` wrote, or throws InputError.
BoardShape parse_board_shape(const JsonNode& node);
UncertaintyMap parse_uncertainty_map(const JsonNode& node);
ModelChoice parse_model_choice(const JsonNode& node);

}  // namespace lensproof::calibration
