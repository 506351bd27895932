#include "calibration/geometry/geometry_json.h"

#include <algorithm>
#include <cmath>

#include "engine/base/json.h"

namespace lensproof::calibration {
namespace {
constexpr const char* kUncertaintyDefinition =
    "standard deviation (px, worst direction) of where a point fixed in the scene would be imaged had the same views "
    "been taken with other noise; intrinsics and poses move together";

Json or_null(const std::optional<double>& value) {
    return value ? Json(*value) : Json();
}

std::optional<double> optional_number(const JsonNode& node) {
    return node.value().is_null() ? std::nullopt : std::optional(node.number());
}

Json list(const std::vector<std::optional<double>>& values) {
    Json result = Json::list();
    for (const auto& value : values) {
        result.push_back(or_null(value));
    }
    return result;
}

std::vector<std::optional<double>> optional_numbers(const JsonNode& node, std::size_t count) {
    std::vector<std::optional<double>> values;
    for (const JsonNode& element : node.elements()) {
        values.push_back(optional_number(element));
    }
    if (values.size() != count) {
        throw node.error("a list of " + std::to_string(count) + " numbers or null");
    }
    return values;
}

Json candidate_json(const ModelCandidate& c) {
    Json json{{"name", c.name}, {"kind", kind_name(empty_model(c.kind))}};
    if (c.radial_terms) {
        json["radial_terms"] = *c.radial_terms;
    }
    json["parameters"] = c.parameters;
    if (!c.refused.empty()) {
        json["refused"] = c.refused;
        return json;
    }
    json["rms_px"] = c.rms_px;
    json["held_out_rms_px"] = c.held_out_rms_px;
    json["halves_difference_px"] = or_null(c.halves_px);
    json["corner_uncertainty_px"] = or_null(c.corner_px);
    json["expected_error_px"] = or_null(c.expected_error_px);
    return json;
}

ModelCandidate parse_candidate(const JsonNode& node) {
    ModelCandidate c;
    c.name = node.at("name").text();
    const auto kind = model_kind(node.at("kind").text());
    if (!kind) {
        throw node.at("kind").error("the name of a lens model");
    }
    c.kind = *kind;
    if (node.has("radial_terms")) {
        c.radial_terms = node.at("radial_terms").count();
    }
    c.parameters = node.at("parameters").count();
    if (node.has("refused")) {
        c.refused = node.at("refused").text();
        return c;
    }
    c.rms_px = node.at("rms_px").number();
    c.held_out_rms_px = node.at("held_out_rms_px").number();
    c.halves_px = optional_number(node.at("halves_difference_px"));
    c.corner_px = optional_number(node.at("corner_uncertainty_px"));
    c.expected_error_px = optional_number(node.at("expected_error_px"));
    return c;
}

}  // namespace

Json to_json(const BoardShape& board) {
    Json heights = Json::object();
    for (std::size_t i = 0; i < kBoardTerms; ++i) {
        heights[std::string(kBoardTermNames[i])] = {{"value", board.height_mm[i]},
                                                    {"standard_error", standard_error_mm(board, i)}};
    }
    return {{"centre_mm", {board.frame.centre_mm.x, board.frame.centre_mm.y}},
            {"half_size_mm", {board.frame.half_size_mm.x, board.frame.half_size_mm.y}},
            {"heights", heights},
            {"covariance", board.covariance}};
}

BoardShape parse_board_shape(const JsonNode& node) {
    BoardShape board;
    board.frame = {node.at("centre_mm").pair(), node.at("half_size_mm").pair()};
    if (!(board.frame.half_size_mm.x > 0.0 && board.frame.half_size_mm.y > 0.0)) {
        throw node.at("half_size_mm").error("positive lengths");
    }
    for (std::size_t i = 0; i < kBoardTerms; ++i) {
        board.height_mm[i] = node.at("heights").at(std::string(kBoardTermNames[i])).at("value").number();
    }
    const auto covariance = node.at("covariance").numbers(board.covariance.size());
    std::copy(covariance.begin(), covariance.end(), board.covariance.begin());
    return board;
}

Json to_json(const UncertaintyMap& map) {
    return {{"definition", kUncertaintyDefinition},
            {"columns", map.columns},
            {"rows", map.rows},
            {"x_px", map.x_px},
            {"y_px", map.y_px},
            {"near_mm", map.near_mm},
            {"far_px", list(map.far_px)},
            {"near_px", list(map.near_px)},
            {"covered", map.covered}};
}

UncertaintyMap parse_uncertainty_map(const JsonNode& node) {
    UncertaintyMap map;
    map.columns = node.at("columns").count();
    map.rows = node.at("rows").count();
    map.x_px = node.at("x_px").numbers(static_cast<std::size_t>(map.columns));
    map.y_px = node.at("y_px").numbers(static_cast<std::size_t>(map.rows));
    map.near_mm = node.at("near_mm").number();
    const std::size_t count = map.x_px.size() * map.y_px.size();
    map.far_px = optional_numbers(node.at("far_px"), count);
    map.near_px = optional_numbers(node.at("near_px"), count);
    for (const JsonNode& covered : node.at("covered").elements()) {
        map.covered.push_back(covered.truth());
    }
    if (map.covered.size() != count) {
        throw node.at("covered").error("a list of " + std::to_string(count) + " truth values");
    }
    return map;
}

Json to_json(const ModelChoice& choice) {
    Json candidates = Json::list();
    for (const ModelCandidate& candidate : choice.candidates) {
        candidates.push_back(candidate_json(candidate));
    }
    return {{"chosen", choice.chosen}, {"why", choice.why}, {"folds", choice.folds}, {"candidates", candidates}};
}

ModelChoice parse_model_choice(const JsonNode& node) {
    ModelChoice choice;
    choice.why = node.at("why").text();
    choice.folds = node.at("folds").count();
    for (const JsonNode& candidate : node.at("candidates").elements()) {
        choice.candidates.push_back(parse_candidate(candidate));
    }
    choice.chosen = node.at("chosen").count();
    if (choice.chosen >= static_cast<int>(choice.candidates.size())) {
        throw node.at("chosen").error("the number of a candidate, from 0");
    }
    return choice;
}

}  // namespace lensproof::calibration
