#include "experiments/studies/stray_light/light_chart.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <string>

#include "experiments/draw/chart.h"
#include "experiments/draw/palette.h"
#include "experiments/findings/shown_picture.h"

namespace lensproof::studies {

namespace {

/// The key of the numbers of which there are most; empty: none is varied.
std::string key_along_x(const StrayScene& scene) {
    std::map<std::string, std::set<double>> numbers;
    std::string best;
    for (const StrayVariant& variant : scene.variants) {
        for (const findings::Axis& axis : variant.at) {
            if (!axis.is_text()) {
                numbers[axis.key].insert(axis.numbers.front());
            }
        }
    }
    for (const auto& [key, values] : numbers) {
        if (values.size() > (best.empty() ? 1 : numbers.at(best).size())) {
            best = key;
        }
    }
    return best;
}

/// Of the variants that differ in this key alone.
struct Panel {
    std::string title;
    std::vector<std::size_t> variants;
    std::vector<double> x;
};

std::vector<Panel> panels_over(const StrayScene& scene, const std::string& key) {
    std::vector<Panel> panels;
    for (std::size_t i = 0; i < scene.variants.size(); ++i) {
        std::vector<findings::Axis> others = scene.variants[i].at;
        const findings::Axis* along = findings::axis_named(scene.variants[i].at, key);
        if (along == nullptr) {
            continue;
        }
        std::erase_if(others, [&](const findings::Axis& axis) { return axis.key == key; });
        const std::string title = findings::words_of(others);
        auto panel = std::ranges::find(panels, title, &Panel::title);
        if (panel == panels.end()) {
            panel = panels.insert(panel, {.title = title, .variants = {}, .x = {}});
        }
        panel->variants.push_back(i);
        panel->x.push_back(along->numbers.front());
    }
    return panels;
}

draw::ChartCurve curve_of(const Panel& panel, const std::string& pass, std::size_t colour,
                          const std::vector<VariantFindings>& variants) {
    draw::ChartCurve curve{.label = pass,
                           .points = {},
                           .colour = draw::series_colour(colour),
                           .marker = draw::CurveMarker::dot,
                           .marker_size = 3.5};
    for (std::size_t i = 0; i < panel.variants.size(); ++i) {
        if (const double light = variants[panel.variants[i]].light(pass).value; light > 0.0) {
            curve.points.push_back({panel.x[i], light});
        }
    }
    std::ranges::sort(curve.points, {}, &Vec2d::x);
    return curve;
}

}  // namespace

std::optional<findings::Picture> light_chart(const StrayScene& scene, const std::vector<VariantFindings>& variants) {
    const std::string key = key_along_x(scene);
    if (key.empty()) {
        return std::nullopt;
    }
    const std::vector<Panel> panels = panels_over(scene, key);
    const findings::Axis along{.key = key};
    constexpr std::size_t kMostColumns = 4;
    draw::ChartGrid grid{.title = scene.title,
                         .caption = "Light of the picture and of its passes",
                         .columns = std::min(kMostColumns, panels.size()),
                         .frame = {.width = 250.0, .height = 190.0}};
    if (grid.columns == 1) {
        grid.frame = {.width = 520.0, .height = 300.0};  // titles have room
    }
    for (const Panel& panel : panels) {
        draw::PlotChart chart{.title = panel.title,
                              .x = {.label = along.title(), .unit = along.unit()},
                              .y = {.label = "Mean over white", .scale = draw::AxisScale::logarithmic}};
        chart.curves.push_back(curve_of(panel, kPicture, 0, variants));
        for (std::size_t pass = 0; scene.passes.size() > 1 && pass < scene.passes.size(); ++pass) {
            chart.curves.push_back(curve_of(panel, scene.passes[pass], pass + 1, variants));
        }
        grid.panels.push_back(std::move(chart));
    }
    return findings::drawn_picture(scene.name + "/light.svg", fmt::format("Light over {}", along.title()),
                                   draw::chart_grid_svg(grid));
}

}  // namespace lensproof::studies
