#include "experiments/studies/sweeps/sweep_charts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "experiments/draw/chart.h"
#include "experiments/draw/palette.h"
#include "experiments/findings/shown_picture.h"

namespace lensproof::studies {

namespace {

/// The axes that neither run along x nor have a curve of each value.
std::vector<std::size_t> panel_axes(const Sweep& sweep) {
    std::vector<std::size_t> axes;
    for (std::size_t a = 0; a < sweep.axes.size(); ++a) {
        const findings::Axis& axis = sweep.axes[a];
        if (axis.is_swept() && axis.key != sweep.over && axis.key != sweep.curves) {
            axes.push_back(a);
        }
    }
    return axes;
}

/// Of all combinations those that have these places in these axes, in order.
std::vector<std::size_t> combinations_at(const Sweep& sweep, const std::vector<std::size_t>& axes,
                                         const std::vector<std::size_t>& places) {
    std::vector<std::size_t> found;
    for (std::size_t i = 0; i < findings::combinations(sweep.axes); ++i) {
        const std::vector<std::size_t> place = findings::place_of(sweep.axes, i);
        bool is_there = true;
        for (std::size_t k = 0; k < axes.size(); ++k) {
            is_there = is_there && place[axes[k]] == places[k];
        }
        if (is_there) {
            found.push_back(i);
        }
    }
    return found;
}

std::size_t index_of(const Sweep& sweep, const std::string& key) {
    return static_cast<std::size_t>(std::ranges::find(sweep.axes, key, &findings::Axis::key) - sweep.axes.begin());
}

std::string colour_of(const findings::Axis* curves, std::size_t i) {
    return curves != nullptr && curves->key == "wavelength_nm" ? draw::wavelength_colour(curves->numbers[i])
                                                               : draw::series_colour(i);
}

/// The curves of a panel: of each value of `curves`, and for each quantity of the family, the first solid, the second
/// dashed.
std::vector<draw::ChartCurve> curves_of(const Sweep& sweep, const std::vector<SweepValue>& values,
                                        const std::vector<std::string>& family, const std::vector<std::size_t>& in) {
    const findings::Axis* curves = findings::axis_named(sweep.axes, sweep.curves);
    const std::size_t over = index_of(sweep, sweep.over);
    const std::size_t by = index_of(sweep, sweep.curves);
    std::vector<draw::ChartCurve> drawn;
    for (std::size_t c = 0; c < (curves == nullptr ? 1 : curves->size()); ++c) {
        for (std::size_t q = 0; q < family.size(); ++q) {
            const std::string quantity = sweep_quantity(family[q]).label;
            const std::string value = curves == nullptr ? "" : curves->label(c);
            draw::ChartCurve curve{
                .label = fmt::format("{}{}{}", value, value.empty() || quantity.empty() ? "" : ", ", quantity),
                .points = {},
                .colour = colour_of(curves, curves == nullptr ? q : c),
                .line = q == 0 ? draw::CurveLine::solid : draw::CurveLine::dashed,
                .marker = draw::CurveMarker::dot,
                .marker_size = 3.5};
            for (const std::size_t i : in) {
                const std::vector<std::size_t> place = findings::place_of(sweep.axes, i);
                if (curves == nullptr || place[by] == c) {
                    curve.points.push_back(
                        {sweep.axes[over].numbers[place[over]],
                         values[i].quantities.at(family[q]).value_or(std::numeric_limits<double>::quiet_NaN())});
                }
            }
            std::ranges::sort(curve.points, {}, &Vec2d::x);
            drawn.push_back(std::move(curve));
        }
    }
    return drawn;
}

/// Equal ratios are shown as equal steps where the values look so.
draw::AxisScale scale_of(const findings::Axis& axis) {
    std::vector<double> finite = axis.numbers;
    std::erase_if(finite, [](double number) { return !std::isfinite(number); });
    const auto [least, most] = std::ranges::minmax_element(finite);
    constexpr double kRatio = 8.0;
    return !finite.empty() && *least > 0.0 && *most >= kRatio * *least ? draw::AxisScale::logarithmic
                                                                       : draw::AxisScale::linear;
}

std::string places_text(const Sweep& sweep, const std::vector<std::size_t>& axes,
                        const std::vector<std::size_t>& places) {
    std::string text;
    for (std::size_t k = 0; k < axes.size(); ++k) {
        text += (text.empty() ? "" : ", ") + sweep.axes[axes[k]].label(places[k]);
    }
    return text;
}

std::string fixed_text(const Sweep& sweep) {
    std::string text;
    for (const findings::Axis& axis : sweep.axes) {
        text += axis.is_swept() ? "" : (text.empty() ? "" : ", ") + axis.label(0);
    }
    return text;
}

findings::Picture family_chart(const Sweep& sweep, const std::vector<SweepValue>& values,
                               const std::vector<std::string>& family) {
    const SweepQuantity& first = sweep_quantity(family.front());
    const findings::Axis& over = *findings::axis_named(sweep.axes, sweep.over);
    const std::vector<std::size_t> axes = panel_axes(sweep);
    std::vector<findings::Axis> panels;
    std::ranges::transform(axes, std::back_inserter(panels), [&](std::size_t axis) { return sweep.axes[axis]; });
    constexpr std::size_t kMostColumns = 4;
    draw::ChartGrid grid{.title = sweep.title,
                         .caption = fixed_text(sweep),
                         .panels = {},
                         .columns = panels.empty() ? 1 : std::min(kMostColumns, panels.back().size()),
                         .frame = {.width = 250.0, .height = 190.0}};
    if (grid.columns == 1) {
        grid.frame = {.width = 520.0, .height = 300.0};  // titles have room
    }
    for (std::size_t i = 0; i < findings::combinations(panels); ++i) {
        const std::vector<std::size_t> places = findings::place_of(panels, i);
        grid.panels.push_back({.title = places_text(sweep, axes, places),
                               .x = {.label = over.title(), .unit = over.unit(), .scale = scale_of(over)},
                               .y = {.label = first.family, .unit = first.unit, .holds_zero = first.is_mtf},
                               .curves = curves_of(sweep, values, family, combinations_at(sweep, axes, places))});
    }
    return findings::drawn_picture(fmt::format("{}/{}.svg", sweep.name, family.front()),
                                   fmt::format("{} over {}", first.family, over.title()), draw::chart_grid_svg(grid));
}

}  // namespace

std::vector<findings::Picture> sweep_charts(const Sweep& sweep, const std::vector<SweepValue>& values) {
    std::vector<std::vector<std::string>> families;
    for (const std::string& quantity : sweep.quantities) {
        const std::string name = sweep_quantity(quantity).family;
        const auto known = std::ranges::find_if(
            families, [&](const auto& family) { return sweep_quantity(family.front()).family == name; });
        if (known == families.end()) {
            families.push_back({quantity});
        } else {
            known->push_back(quantity);
        }
    }
    std::vector<findings::Picture> charts;
    std::ranges::transform(families, std::back_inserter(charts),
                           [&](const auto& family) { return family_chart(sweep, values, family); });
    return charts;
}

}  // namespace lensproof::studies
