// calibration/statistics/estimates_json.h — a fit's terms as JSON.
#pragma once
#include <string>
#include <vector>

#include "engine/base/json_archive.h"

namespace lensproof::calibration {

/// `parameters`: of each name its `value` and its `standard_error`, which the covariance (row by row) says.
void estimates(JsonArchive& json, std::vector<std::string>& names, std::vector<double>& values,
               const std::vector<double>& covariance);

}  // namespace lensproof::calibration
