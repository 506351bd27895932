// calibration/geometry/geometry_json.h — a profile's board shape, projection uncertainty and model choice as JSON.
#pragma once

#include "calibration/geometry/board_shape.h"
#include "calibration/geometry/model_choice.h"
#include "calibration/geometry/projection_uncertainty.h"
#include "engine/base/json_archive.h"

namespace lensproof::calibration {

void fields(JsonArchive& json, BoardShape& board);
void fields(JsonArchive& json, UncertaintyMap& map);
void fields(JsonArchive& json, ModelCandidate& candidate);
void fields(JsonArchive& json, ModelChoice& choice);

}  // namespace lensproof::calibration
