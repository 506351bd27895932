// engine/scene/chart/colour_checker.h — a card of measured colours.
#pragma once
#include <cmath>
#include <optional>

#include "engine/base/kinds.h"
#include "engine/scene/chart/chart_traits.h"
#include "engine/scene/chart/outline.h"

namespace lensproof::scene {

/// The 6 × 4 patches of a colour checker, `gap_mm` apart and as far from the card's edge. What the patches reflect
/// texture.h knows; here they are white, on black.
struct ColourChecker {
    static constexpr KindNames<> kNames{"colour-checker"};
    static constexpr const char* kNotPrinted = "what its patches reflect is measured, and no printer repeats it";
    static constexpr GridSize kPatches{6, 4};
    double patch_mm = 0.0;
    double gap_mm = 0.0;

    [[nodiscard]] double pitch_mm() const { return patch_mm + gap_mm; }
};

void visit_keys(ColourChecker& checker, auto& keys) {
    keys.length("patch_mm", checker.patch_mm, ColourChecker::kPatches);
    keys.length("gap_mm", checker.gap_mm, ColourChecker::kPatches);
}

inline ChartTraits traits(const ColourChecker& checker) {
    const auto [columns, rows] = ColourChecker::kPatches;
    return {.points = {columns, rows},
            .pitch_mm = checker.pitch_mm(),
            .size_mm = {columns * checker.pitch_mm() + checker.gap_mm, rows * checker.pitch_mm() + checker.gap_mm},
            .look = Unsearched()};
}

/// The patch at (x, y) mm, row by row from 0 at the top left (a ColorChecker's "dark skin"); nothing between patches.
inline std::optional<int> patch_at(const ColourChecker& checker, double x_mm, double y_mm) {
    const double pitch_mm = checker.pitch_mm();
    const Cell cell = cell_at(ColourChecker::kPatches, pitch_mm, x_mm, y_mm);
    const bool is_patch = cell.is_on_grid && is_in_square(cell.x * pitch_mm, cell.y * pitch_mm, checker.patch_mm);
    return is_patch ? std::optional(cell.row * ColourChecker::kPatches.columns + cell.column) : std::nullopt;
}

inline bool is_black(const ColourChecker& checker, double x_mm, double y_mm) {
    const Vec2d size = traits(checker).size_mm;
    return std::abs(x_mm) < 0.5 * size.x && std::abs(y_mm) < 0.5 * size.y && !patch_at(checker, x_mm, y_mm);
}

inline Outline outline(const ColourChecker& checker) {
    const double half = 0.5 * checker.patch_mm;
    Outline outline{rectangle(traits(checker).size_mm)};
    for (const Vec2d& centre : cell_middles(ColourChecker::kPatches, checker.pitch_mm())) {
        outline.push_back(rectangle({centre.x - half, centre.y - half}, {centre.x + half, centre.y + half}, false));
    }
    return outline;
}

}  // namespace lensproof::scene
