#include "calibration/light/vignetting_json.h"

#include <fmt/format.h>

#include "calibration/statistics/estimates_json.h"

namespace lensproof::calibration {
namespace {
// One of the cells' members, over the cells.
template <class T>
void column(JsonArchive& json, const char* key, ShadingGrid& grid, T ShadingGrid::Cell::*member, const char* what) {
    std::vector<T> values;
    for (const ShadingGrid::Cell& cell : grid.cells) {
        values.push_back(cell.*member);
    }
    json.field(key, values).expect(key, values.size() == grid.cells.size(), fmt::format("a list of 121 {}", what));
    for (std::size_t i = 0; i < grid.cells.size(); ++i) {
        grid.cells[i].*member = values[i];
    }
}

}  // namespace

void fields(JsonArchive& json, VignettingModel& model) {
    json.field("name", model.name);
    estimates(json, model.parameter_names, model.values, model.covariance);
    json.numbers("covariance", model.covariance, model.values.size() * model.values.size())
        .field("relative_rms", model.relative_rms);
    if (!json.lacks("verdict")) {
        json.field("held_out_relative_rms", model.held_out_relative_rms);
    }
    json.field("aicc", model.aicc).added("verdict", model.verdict);
}

void fields(JsonArchive& json, ShadingGrid& grid) {
    json.constant("columns", ShadingGrid::kSide, "11").constant("rows", ShadingGrid::kSide, "11");
    column(json, "mean", grid, &ShadingGrid::Cell::mean, "numbers");
    column(json, "standard_error", grid, &ShadingGrid::Cell::standard_error, "numbers");
    column(json, "samples", grid, &ShadingGrid::Cell::samples, "counts");
}

}  // namespace lensproof::calibration
