#include "calibration/light/vignetting_json.h"

#include <algorithm>
#include <cmath>

#include "engine/base/json.h"

namespace lensproof::calibration {
Json to_json(const std::vector<VignettingModel>& models) {
    Json list = Json::list();
    for (const VignettingModel& model : models) {
        Json json = {{"name", model.name}, {"parameters", Json::object()}};
        const std::size_t count = model.values.size();
        for (std::size_t i = 0; i < count; ++i) {
            json["parameters"][model.parameter_names[i]] = {
                {"value", model.values[i]},
                {"standard_error", std::sqrt(std::max(model.covariance[i * (count + 1)], 0.0))}};
        }
        json["covariance"] = model.covariance;
        json["relative_rms"] = model.relative_rms;
        json["held_out_relative_rms"] = model.held_out_relative_rms;
        json["aicc"] = model.aicc;
        json["verdict"] = model.verdict;
        list.push_back(std::move(json));
    }
    return list;
}

std::vector<VignettingModel> parse_vignetting_models(const JsonNode& node) {
    std::vector<VignettingModel> models;
    for (const JsonNode& entry : node.elements()) {
        VignettingModel model;
        model.name = entry.at("name").text();
        const JsonNode parameters = entry.at("parameters");
        model.parameter_names = parameters.keys();
        for (const std::string& name : model.parameter_names) {
            model.values.push_back(parameters.at(name).at("value").number());
        }
        model.covariance = entry.at("covariance").numbers(model.values.size() * model.values.size());
        model.relative_rms = entry.at("relative_rms").number();
        model.aicc = entry.at("aicc").number();
        if (entry.has("verdict")) {
            model.held_out_relative_rms = entry.at("held_out_relative_rms").number();
            model.verdict = entry.at("verdict").text();
        }
        models.push_back(std::move(model));
    }
    return models;
}

Json to_json(const ShadingGrid& grid) {
    Json json = {{"columns", ShadingGrid::kSide}, {"rows", ShadingGrid::kSide}};
    for (const ShadingGrid::Cell& cell : grid.cells) {
        json["mean"].push_back(cell.mean);
        json["standard_error"].push_back(cell.standard_error);
        json["samples"].push_back(cell.samples);
    }
    return json;
}

ShadingGrid parse_shading_grid(const JsonNode& node) {
    for (const char* side : {"columns", "rows"}) {
        if (node.at(side).count() != ShadingGrid::kSide) {
            throw node.at(side).error("11");
        }
    }
    ShadingGrid grid;
    const auto mean = node.at("mean").numbers(grid.cells.size());
    const auto error = node.at("standard_error").numbers(grid.cells.size());
    const auto samples = node.at("samples").elements();
    if (samples.size() != grid.cells.size()) {
        throw node.at("samples").error("a list of 121 counts");
    }
    for (std::size_t i = 0; i < grid.cells.size(); ++i) {
        grid.cells.at(i) = {mean[i], error[i], samples[i].count()};
    }
    return grid;
}

}  // namespace lensproof::calibration
