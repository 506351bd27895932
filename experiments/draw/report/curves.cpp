#include "experiments/draw/report/curves.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>
#include <optional>
#include <vector>

#include "engine/base/infinity.h"
#include "engine/base/markup.h"
#include "experiments/draw/chart.h"
#include "experiments/draw/chart_axes.h"
#include "experiments/draw/chart_legend.h"
#include "experiments/draw/report/html_text.h"

namespace lensproof::draw {
namespace {

constexpr ChartSize kWide{640.0, 364.0};
constexpr ChartSize kNarrow{400.0, 290.0};
constexpr PanelLook kLook{.has_legend = false, .has_viewport = true};
constexpr double kBandOpacity = 0.17;
constexpr std::array kDots = {0.0, 6.0, 9.0, 3.5};

/// A sample of a curve with its 95 % band; NaN where the report has none.
struct Sample {
    double x = 0.0;
    double y = kNaN;
    double low = kNaN;
    double high = kNaN;
};

struct Series {
    std::string label;
    std::string style;  // "measured", "reference" or "difference"
    std::string colour;
    double dot = 0.0;  // px; on the line of those that share colour and style, to tell them apart
    std::string group;
    std::vector<Sample> samples;    // by rising x
    std::optional<double> floor;    // the method's own error
    double covered_to = kInfinity;  // beyond this x the data ended

    [[nodiscard]] bool ends_early() const { return !samples.empty() && samples.back().x > covered_to; }
    [[nodiscard]] bool has_band() const {
        return std::ranges::any_of(samples, [](const Sample& s) { return std::isfinite(s.low); });
    }
    [[nodiscard]] ChartCurve line() const {
        const bool is_reference = style == "reference";
        return {.colour = is_reference ? "color-mix(in srgb, " + colour + " 45%, var(--ink))" : colour,
                .line = is_reference ? CurveLine::dashed : CurveLine::solid,
                .width = is_reference ? 1.5 : 1.9,
                .group = group};
    }
};

std::vector<Sample> samples_of(const Json& series) {
    const auto at = [&](const char* column, std::size_t i) {
        const Json::List& values = series[column].elements();
        return i < values.size() ? as_number(values[i]).value_or(kNaN) : kNaN;
    };
    std::vector<Sample> samples;
    for (std::size_t i = 0; i < series["x"].size(); ++i) {
        samples.push_back({at("x", i), at("y", i), at("lower", i), at("upper", i)});
    }
    std::erase_if(samples, [](const Sample& sample) { return !std::isfinite(sample.x); });
    std::ranges::stable_sort(samples, {}, &Sample::x);
    return samples;
}

std::vector<Series> series_of(const Json& report, const Json& plot) {
    std::vector<Series> all;
    std::map<std::string, std::size_t> used;
    for (const Json& json : plot["series"]) {
        if (!json.is_object()) continue;
        const auto colour = subject_colour(report, json["subject"]);
        const std::string style = as_text(json["style"]);
        const std::string label = as_text(json["label"]);
        Series series{.label = label.empty() ? "series " + std::to_string(all.size() + 1) : label,
                      .style = style == "reference" || style == "difference" ? style : "measured",
                      .colour = colour ? fmt::format("var(--c{})", *colour) : "var(--quiet)",
                      .group = fmt::format("series-{}", all.size()),
                      .samples = samples_of(json),
                      .floor = as_number(json["floor"]),
                      .covered_to = as_number(json["covered_to"]).value_or(kInfinity)};
        series.dot = kDots[used[series.colour + series.style]++ % kDots.size()];
        all.push_back(std::move(series));
    }
    return all;
}

/// Straight between two samples, as the line is drawn; NaN outside, and where a sample is missing.
Sample value_at(const Series& series, double x) {
    const auto after = std::ranges::lower_bound(series.samples, x, {}, &Sample::x);
    if (after == series.samples.end() || (after == series.samples.begin() && after->x != x)) return {.x = x};
    if (after->x == x) return *after;
    const Sample& before = *(after - 1);
    const double t = (x - before.x) / (after->x - before.x);
    const auto mix = [&](double Sample::*of) { return before.*of + t * ((*after).*of - before.*of); };
    return {x, mix(&Sample::y), mix(&Sample::low), mix(&Sample::high)};
}

// ---- The chart -----------------------------------------------------------------------------------------------------

/// Bands, where both bounds are known.
void add_bands(PlotChart& chart, const Series& series, const std::vector<Sample>& samples, bool is_covered) {
    const auto has_both = [](const Sample& s) { return std::isfinite(s.low) && std::isfinite(s.high); };
    for (auto from = samples.begin(); from != samples.end();) {
        const auto to = std::find_if_not(from, samples.end(), has_both);
        ChartArea band{.colour = series.colour,
                       .opacity = is_covered ? kBandOpacity : 0.4,
                       .is_hatched = !is_covered,
                       .sets_y_range = is_covered,
                       .group = series.group};
        for (auto s = from; s != to; ++s) band.outline.push_back({s->x, s->high});
        for (auto s = to; s != from; --s) band.outline.push_back({(s - 1)->x, (s - 1)->low});
        if (to - from > 1) chart.areas.push_back(std::move(band));
        from = std::find_if(to, samples.end(), has_both);
    }
}

void add_series(PlotChart& chart, const Series& series) {
    std::vector<Sample> covered;
    std::vector<Sample> beyond;
    for (const Sample& sample : series.samples) (sample.x > series.covered_to ? beyond : covered).push_back(sample);
    if (!beyond.empty()) {
        const Sample end = value_at(series, series.covered_to);
        if (!covered.empty()) covered.push_back(end);
        beyond.insert(beyond.begin(), end);
    }
    add_bands(chart, series, beyond, false);
    add_bands(chart, series, covered, true);
    const auto points_of = [](const std::vector<Sample>& samples, double scale, double offset) {
        std::vector<Vec2d> points;
        std::ranges::transform(samples, std::back_inserter(points), [&](const Sample& s) -> Vec2d {
            return {s.x, std::isfinite(s.y) ? scale * s.y + offset : kNaN};
        });
        return points;
    };
    ChartCurve line = series.line();
    line.points = points_of(covered, 1.0, 0.0);
    chart.curves.push_back(line);
    line.points = points_of(beyond, 1.0, 0.0);
    line.opacity = 0.38;
    line.sets_y_range = false;
    chart.curves.push_back(line);
    if (series.floor && *series.floor > 0.0) {
        for (const double own : {*series.floor, -*series.floor}) {  // about the curve, or about no difference
            chart.curves.push_back({.points = points_of(covered, series.style == "difference" ? 0.0 : 1.0, own),
                                    .colour = series.colour,
                                    .line = CurveLine::dotted,
                                    .width = 1.0,
                                    .opacity = 0.85,
                                    .group = series.group});
        }
    }
    if (series.dot > 0.0 && !covered.empty()) {
        constexpr int kCount = 9;
        ChartCurve dots = series.line();
        dots.line = CurveLine::none;
        dots.marker = CurveMarker::dot;  // which keeps its shape when one axis is zoomed
        dots.marker_size = series.dot;
        for (int i = 0; i < kCount; ++i) {
            const double x = std::lerp(covered.front().x, covered.back().x, (i + 0.5) / kCount);
            dots.points.push_back({x, value_at(series, x).y});
        }
        chart.curves.push_back(dots);
    }
}

/// The chart in a frame of that size. Zero and the limit's band reach across whatever the frame shows.
std::string canvas(PlotChart chart, ChartSize size, std::optional<double> limit, const std::string& attributes) {
    const ChartFrame frame = fitted_frame(chart, size, kLook, 2.0);
    if (limit) {
        const double left = frame.x.low;
        const double right = frame.x.high;
        chart.areas.insert(chart.areas.begin(),
                           {.outline = {{left, *limit}, {right, *limit}, {right, -*limit}, {left, -*limit}},
                            .colour = "var(--quiet)",
                            .opacity = 0.09});
    }
    chart.references.insert(
        chart.references.begin(),
        {.direction = ReferenceDirection::horizontal, .colour = "var(--rule)", .line = CurveLine::solid});
    Svg svg;
    draw_chart(svg, chart, frame, kLook);
    return svg.element(size.width, size.height,
                       fmt::format(R"(data-frame="{} {} {} {}" role="img" {})", frame.box.x, frame.box.y,
                                   frame.box.width, frame.box.height, attributes));
}

// ---- The figure ----------------------------------------------------------------------------------------------------

constexpr double kSampleWidth = 30.0;  // of the legend's samples
constexpr double kSampleMiddle = 6.0;

std::string legend_entry(const std::string& colour, const std::string& box, const Svg& sample,
                         const std::string& name) {
    return fmt::format("<li style=\"--c: {}\"><label>{}{}<span>{}</span></label>{}</li>\n", colour, box,
                       sample.element(kSampleWidth, 2.0 * kSampleMiddle, "aria-hidden=\"true\""), name,
                       box.empty() ? "" : "<output></output>");
}

std::string legend_item(const Series& series, const std::string& x_unit, const std::string& y_unit) {
    Svg svg;
    if (series.has_band()) {
        svg.rectangle({0.0, 0.0}, kSampleWidth, 2.0 * kSampleMiddle, {.fill = series.colour, .opacity = kBandOpacity});
    }
    const ChartCurve line = series.line();
    svg.line({0.0, kSampleMiddle}, {kSampleWidth, kSampleMiddle},
             {.stroke = line.colour, .width = line.width, .dashes = dash_pattern(line.line)});
    if (series.dot > 0.0)
        draw_markers(svg, {{0.5 * kSampleWidth, kSampleMiddle}}, CurveMarker::dot, series.dot, series.colour);
    const std::string label = escape_markup(series.label);
    std::string name = label;
    const auto add = [&](const char* what, const std::string& number, const std::string& unit) {
        name += fmt::format(" <small class=\"note\">{}{}</small>", what, with_unit(number, unit));
    };
    if (series.ends_early()) add("data to ", short_number(series.covered_to, 4), x_unit);
    if (series.floor) add("own error ±", floor_text(*series.floor), y_unit);
    return legend_entry(series.colour,
                        R"(<input class="live" type="checkbox" checked aria-label="show )" + label + "\">", svg, name);
}

/// The curves as numbers, for who cannot see them or wants to check one.
std::string values_table(const std::string& title, const std::string& x_name, const std::vector<Series>& all,
                         const std::vector<double>& places) {
    std::string out =
        "<details><summary>Values</summary><div class=\"wide\" tabindex=\"0\" role=\"region\" "
        "aria-label=\"values of " +
        title + "\"><table class=\"list\"><thead><tr><th scope=\"col\">" + x_name + "</th>";
    for (const Series& series : all) out += "<th scope=\"col\">" + escape_markup(series.label) + "</th>";
    out += "</tr></thead><tbody>\n";
    const auto row = [&](const std::string& head, const auto& cell) {
        out += "<tr><th scope=\"row\">" + head + "</th>";
        for (const Series& series : all) out += "<td>" + cell(series) + "</td>";
        out += "</tr>\n";
    };
    for (const double x : places) {
        row(number_text(x), [&](const Series& series) {
            const Sample at = value_at(series, x);
            const std::string number = measurement_text(at.y, 0.5 * (at.high - at.low));
            return std::isfinite(at.y) && x > series.covered_to ? number + " (extrapolated)" : number;
        });
    }
    if (std::ranges::any_of(all, [](const Series& series) { return series.floor.has_value(); })) {
        row("method's own error, rms",
            [](const Series& series) { return series.floor ? floor_text(*series.floor) : "—"; });
    }
    return out + "</tbody></table></div></details>\n";
}

std::string figure(const Json& report, const Json& plot, std::size_t place) {
    const std::vector<Series> all = series_of(report, plot);
    PlotChart chart{.caption = axis_title({as_text(plot["y_label"]), as_text(plot["y_unit"])}, {}),
                    .x = {as_text(plot["x_label"]), as_text(plot["x_unit"])}};
    for (const Series& series : all) add_series(chart, series);
    std::optional<double> limit = as_number(plot["limit"]);
    ChartFrame frame = fitted_frame(chart, kWide, kLook, 2.0);
    std::string limit_item;
    if (limit) {
        limit = std::abs(*limit);
        // A limit far beyond the curves would flatten them.
        const bool is_near = *limit < 8.0 * std::max(std::abs(frame.y.low), std::abs(frame.y.high));
        for (const double edge : {*limit, -*limit}) {
            if (is_near) {
                chart.references.push_back({.direction = ReferenceDirection::horizontal,
                                            .at = edge,
                                            .colour = "var(--quiet)",
                                            .line = CurveLine::dotted});
            }
        }
        frame = fitted_frame(chart, kWide, kLook, 2.0);
        Svg svg;
        svg.rectangle({0.0, 0.0}, kSampleWidth, 2.0 * kSampleMiddle, {.fill = "var(--quiet)", .opacity = kBandOpacity});
        limit_item = legend_entry(
            "var(--quiet)", "", svg,
            "limit ±" + with_unit(number_text(*limit), text(plot, "y_unit")) + (is_near ? "" : ": outside this view"));
    }
    chart.x.low = frame.x.low;  // both sizes show the same
    chart.x.high = frame.x.high;
    chart.y.low = frame.y.low;
    chart.y.high = frame.y.high;
    const std::string title = text(plot, "title");
    const std::string x_name = escape_markup(axis_title(chart.x, {}));
    const std::string label =
        fmt::format("aria-label=\"{}: {} against {}.\"", title, escape_markup(chart.caption), x_name);
    std::string out = fmt::format(
        R"(<figure class="plot" data-plot="{}" data-place="{}" data-view="{} {} {} {}"><header><div><h3>{}</h3>{}</div>
<button class="live closer" type="button" aria-label="Zoom in: {}">Zoom in</button>
<button class="live reset" type="button" aria-label="Reset zoom: {}" disabled>Reset</button></header>
)",
        text(plot, "id"), place, frame.x.low, frame.x.high, frame.y.low, frame.y.high, title,
        plot["subtitle"].is_null() ? "" : "<p>" + text(plot, "subtitle") + "</p>", title, title);
    out += canvas(chart, kWide, limit, "class=\"canvas wide-canvas\" " + label);
    out += canvas(chart, kNarrow, limit, "class=\"canvas narrow-canvas\" " + label);
    out += "<output class=\"at\"></output><p class=\"unseen\" aria-live=\"polite\"></p>\n<ul class=\"legend\">\n";
    for (const Series& series : all) out += legend_item(series, text(plot, "x_unit"), text(plot, "y_unit"));
    return out + limit_item + "</ul>\n" + values_table(title, x_name, all, frame.x.ticks.major) + "</figure>\n";
}

}  // namespace

std::string curves_html(const Json& report) {
    std::string figures;
    const Json::List& plots = report["plots"].elements();
    for (std::size_t i = 0; i < plots.size(); ++i) {
        if (plots[i].is_object()) figures += figure(report, plots[i], i);
    }
    return figures.empty() ? "<p class=\"empty\">This report holds no curves.</p>" : figures;
}

}  // namespace lensproof::draw
