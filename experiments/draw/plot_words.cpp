#include "experiments/draw/plot_words.h"

#include <algorithm>
#include <cmath>

#include "experiments/draw/colour_map.h"
#include "experiments/draw/palette.h"
#include "experiments/draw/ticks.h"

namespace lensproof::draw {

std::string plot_title(const PlotHeading& heading, const std::string& what) {
    return heading.lens.empty() ? what : heading.lens + " · " + what;
}

std::string field_text(double field_deg) {
    return short_number(field_deg, 4) + "°";
}

std::string wavelength_text(double wavelength_nm) {
    return short_number(wavelength_nm, 4) + " nm";
}

ReferenceLine zero_line(ReferenceDirection direction) {
    return {.direction = direction, .at = 0.0, .colour = "#9aa1ac", .line = CurveLine::solid};
}

ChartCurve wavelength_curve(const analysis::WavelengthCurve& curve) {
    return {.label = wavelength_text(curve.wavelength_nm),
            .points = curve.points,
            .colour = wavelength_colour(curve.wavelength_nm)};
}

ChartCurve legend_only(const std::string& label, CurveLine line) {
    return {.label = label, .colour = kQuiet, .line = line};
}

std::vector<Vec2d> in_order(std::vector<Vec2d> points) {
    std::ranges::stable_sort(points, {}, [](Vec2d point) { return std::isfinite(point.x) ? point.x : 0.0; });
    return points;
}

std::string ordered_colour(std::size_t index, std::size_t count) {
    constexpr std::size_t kDistinct = 6;
    if (count <= kDistinct) {
        return series_colour(index);
    }
    // Up to where the map is still dark enough for white paper.
    return map_colour_text(ColourMap::sequential,
                           0.05 + 0.6 * static_cast<double>(index) / static_cast<double>(count - 1));
}

}  // namespace lensproof::draw
