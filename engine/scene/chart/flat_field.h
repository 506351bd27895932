// engine/scene/chart/flat_field.h — an even white, to measure light on.
#pragma once
#include "engine/base/kinds.h"
#include "engine/scene/chart/chart_traits.h"
#include "engine/scene/chart/outline.h"

namespace lensproof::scene {

/// One even tone without an edge.
struct FlatField {
    static constexpr KindNames<> kNames{"flat-field"};
};

void visit_keys(FlatField&, auto&) {}

inline bool is_black(const FlatField&, double, double) {
    return false;
}

inline ChartTraits traits(const FlatField&) {
    return {.points = {}, .size_mm = {}, .look = NoPoints()};
}

inline Outline outline(const FlatField&) {
    return {};
}

}  // namespace lensproof::scene
