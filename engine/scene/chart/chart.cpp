#include "engine/scene/chart/chart.h"

#include <algorithm>
#include <tuple>

namespace lensproof::scene {

bool is_black(const Chart& chart, double x_mm, double y_mm) {
    return std::visit([&](const auto& pattern) { return is_black(pattern, x_mm, y_mm); }, chart.pattern);
}

ChartTraits traits(const Chart& chart) {
    return std::visit([](const auto& pattern) { return traits(pattern); }, chart.pattern);
}

Outline outline(const Chart& chart) {
    return std::visit([](const auto& pattern) { return outline(pattern); }, chart.pattern);
}

double reflectance(const Chart& chart, double x_mm, double y_mm) {
    return is_black(chart, x_mm, y_mm) ? chart.black_reflectance : chart.white_reflectance;
}

void reflectances(const Chart& chart, std::span<const double> x_mm, std::span<const double> y_mm,
                  std::span<double> reflectance) {
    std::visit(
        [&](const auto& pattern) {
            for (std::size_t i = 0; i < reflectance.size(); ++i) {
                reflectance[i] =
                    is_black(pattern, x_mm[i], y_mm[i]) ? chart.black_reflectance : chart.white_reflectance;
            }
        },
        chart.pattern);
}

std::vector<Vec2d> feature_points(const Chart& chart) {
    const ChartTraits known = traits(chart);
    return cell_middles(known.points, known.pitch_mm);
}

GridSize feature_grid(const Chart& chart) {
    return traits(chart).points;
}

Vec2d pattern_size_mm(const Chart& chart) {
    return traits(chart).size_mm;
}

std::string kind_name(const Chart& chart) {
    return std::visit([](const auto& pattern) { return std::string(pattern.kNames.front()); }, chart.pattern);
}

std::vector<ChartKind> chart_kinds() {
    std::vector<ChartKind> kinds;
    for_each_kind<ChartPattern>([&](const auto& pattern) {
        kinds.push_back({.name = std::string(pattern.kNames.front()), .look = traits(pattern).look, .not_printed = {}});
        if constexpr (requires { pattern.kNotPrinted; }) {
            kinds.back().not_printed = pattern.kNotPrinted;
        }
    });
    std::ranges::sort(kinds, {}, [](const ChartKind& kind) { return std::tuple(kind.look.index(), kind.name); });
    return kinds;
}

}  // namespace lensproof::scene
