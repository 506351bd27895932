#include "calibration/geometry/geometry_json.h"

#include <fmt/format.h>

namespace lensproof::calibration {
namespace {
constexpr const char* kUncertaintyDefinition =
    "standard deviation (px, worst direction) of where a point fixed in the scene would be imaged had the same views "
    "been taken with other noise; intrinsics and poses move together; with models_px, how far models that predict the "
    "pictures as well differ from it, added in squares";

}  // namespace

void fields(JsonArchive& json, BoardShape& board) {
    Vec2d& half_size = board.frame.half_size_mm;
    json.field("centre_mm", board.frame.centre_mm)
        .field("half_size_mm", half_size)
        .expect("half_size_mm", half_size.x > 0.0 && half_size.y > 0.0, "positive lengths")
        .group("heights",
               [&](JsonArchive& heights) {
                   for (std::size_t i = 0; i < kBoardTerms; ++i) {
                       heights.group(kBoardTermNames[i], [&](JsonArchive& term) {
                           term.field("value", board.height_mm[i]);
                           term.derived("standard_error", standard_error_mm(board, i));
                       });
                   }
               })
        .field("covariance", board.covariance);
}

void fields(JsonArchive& json, UncertaintyMap& map) {
    json.derived("definition", kUncertaintyDefinition).field("columns", map.columns).field("rows", map.rows);
    json.numbers("x_px", map.x_px, static_cast<std::size_t>(map.columns));
    json.numbers("y_px", map.y_px, static_cast<std::size_t>(map.rows));
    json.field("near_mm", map.near_mm);
    const std::size_t count = map.x_px.size() * map.y_px.size();
    for (const auto& [key, values] : {std::pair("far_px", &map.far_px), std::pair("near_px", &map.near_px)}) {
        json.field(key, *values);
        json.expect(key, values->size() == count, fmt::format("a list of {} numbers or null", count));
    }
    if (json.reading() ? !json.lacks("models_px") : !map.models_px.empty()) {
        json.field("models_px", map.models_px)
            .expect("models_px", map.models_px.size() == count, fmt::format("a list of {} numbers or null", count));
    }
    json.field("covered", map.covered)
        .expect("covered", map.covered.size() == count, fmt::format("a list of {} truth values", count));
}

void fields(JsonArchive& json, ModelCandidate& candidate) {
    json.field("name", candidate.name)
        .one_of("kind", candidate.kind, model_kind_names(), "the name of a lens model")
        .optional("radial_terms", candidate.radial_terms)
        .field("parameters", candidate.parameters)
        .optional("refused", candidate.refused);
    if (json.reading() ? json.lacks("refused") : candidate.refused.empty()) {
        json.field("rms_px", candidate.rms_px)
            .field("held_out_rms_px", candidate.held_out_rms_px)
            .field("halves_difference_px", candidate.halves_px)
            .field("corner_uncertainty_px", candidate.corner_px)
            .field("expected_error_px", candidate.expected_error_px);
    }
}

void fields(JsonArchive& json, ModelChoice& choice) {
    json.field("chosen", choice.chosen)
        .field("why", choice.why)
        .field("folds", choice.folds)
        .optional("corner_disagreement_px", choice.corner_disagreement_px)
        .field("candidates", choice.candidates)
        .expect("chosen", choice.chosen < static_cast<int>(choice.candidates.size()),
                "the number of a candidate, from 0");
}

}  // namespace lensproof::calibration
