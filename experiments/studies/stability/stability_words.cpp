#include "experiments/studies/stability/stability_words.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "experiments/draw/chart.h"
#include "experiments/draw/palette.h"
#include "experiments/studies/stability/stability_study.h"

namespace lensproof::studies {

namespace {

/// The statuses met, without their counts: "ok, clipped"; or what the program says.
std::string outcome(const StabilityPoint& point) {
    if (!point.refusal.empty()) {
        return "refused";
    }
    std::string names;
    for (const auto& [name, count] : point.fates) {
        names += (names.empty() ? "" : ", ") + name;
    }
    return point.at_a_change == 0            ? names
           : point.at_a_change == point.rays ? names + "; every ray within rounding of a change"
                                             : names + "; some rays within rounding of a change";
}

std::string range_text(double from, double to, const std::string& unit) {
    return from == to ? value_text(from, unit) : value_text(from, unit) + " … " + value_text(to, unit);
}

draw::PlotChart chart_of(const StabilitySweep& sweep) {
    const Extreme& extreme = sweep.extreme;
    draw::PlotChart chart{
        .title = extreme.title,
        .caption = extreme.setting,
        .x = {.label = extreme.parameter,
              .unit = extreme.unit,
              .scale = extreme.is_logarithmic ? draw::AxisScale::logarithmic : draw::AxisScale::linear},
        .y = {.label = "largest error", .unit = "mm", .scale = draw::AxisScale::logarithmic},
        .references = {{.direction = draw::ReferenceDirection::horizontal, .at = kErrorBoundMm, .label = "1e-9"}}};
    constexpr std::array kMarkers = {draw::CurveMarker::ring, draw::CurveMarker::dot, draw::CurveMarker::triangle};
    const auto add = [&](const std::string& label, const auto& y_of, draw::ChartCurve look) {
        look.label = label;
        for (const StabilityPoint& point : sweep.points) {
            const double y = y_of(point);
            // An error of 0 and a value of 0 or ∞ have no place on logarithmic axes; report.json has them.
            const bool is_shown =
                std::isfinite(point.value) && (!extreme.is_logarithmic || point.value > 0.0) && y > 0.0;
            if (is_shown) {
                look.points.push_back({point.value, y});
            }
        }
        chart.curves.push_back(std::move(look));
    };
    for (std::size_t type = 0; type < kNumberTypes.size(); ++type) {
        add(kNumberTypes.at(type), [type](const StabilityPoint& point) { return point.types.at(type).error_mm; },
            {.colour = draw::series_colour(type), .marker = kMarkers.at(type)});
    }
    add("half an ulp of the input moves a point by", [](const StabilityPoint& point) { return point.conditioning_mm; },
        {.colour = draw::kQuiet, .line = draw::CurveLine::dashed});
    return chart;
}

}  // namespace

std::string value_text(double value, const std::string& unit) {
    if (std::isinf(value)) {
        return value > 0.0 ? "∞" : "−∞";
    }
    std::string number = fmt::format("{:.12g}", value);
    if (std::abs(value) >= 1e5) {
        number = fmt::format("{:.6e}", value);  // 1.000000e+09
        const std::size_t exponent = number.find('e');
        std::string digits = number.substr(0, exponent);
        digits.erase(digits.find_last_not_of("0.") + 1);
        number = fmt::format("{}e{}", digits, std::stoi(number.substr(exponent + 1)));
    }
    return unit.empty() || unit == "°" ? number + unit : number + " " + unit;
}

std::string trouble_text(const StabilitySweep& sweep, std::size_t type, double limit_mm) {
    double largest = 0.0;
    for (const StabilityPoint& point : sweep.points) {
        largest = std::max(largest, point.types.at(type).error_mm);
    }
    const std::optional<Onset> onset = onset_of_trouble(sweep, type);
    if (!onset) {
        return fmt::format("at most {:.2g} mm", largest);
    }
    return fmt::format("over {:g} mm at {}, at most {:.2g} mm{}", limit_mm,
                       range_text(onset->from, onset->to, sweep.extreme.unit), largest,
                       onset->is_conditioning ? "; within ten times what rounding the input does" : "");
}

std::vector<findings::Fact> what_happens(const StabilitySweep& sweep) {
    std::vector<findings::Fact> facts;
    for (std::size_t i = 0; i < sweep.points.size();) {
        const std::string what = outcome(sweep.points[i]);
        std::size_t last = i;
        while (last + 1 < sweep.points.size() && outcome(sweep.points[last + 1]) == what) {
            ++last;
        }
        const std::string& refusal = sweep.points[i].refusal;
        facts.push_back({.label = range_text(sweep.points[i].value, sweep.points[last].value, sweep.extreme.unit),
                         .value = refusal.empty() ? what : "refused: " + refusal});
        i = last + 1;
    }
    return facts;
}

std::string stability_chart(const StabilitySweep& sweep) {
    return draw::chart_svg(chart_of(sweep), {.width = kStabilityChartWidth, .height = kStabilityChartHeight});
}

}  // namespace lensproof::studies
