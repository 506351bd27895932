#include "experiments/studies/stray_light/measured_chart.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>

#include "experiments/draw/chart.h"
#include "experiments/draw/palette.h"

namespace lensproof::studies {

namespace {

std::vector<std::string> quantity_keys() {
    std::vector<std::string> keys;
    std::ranges::transform(look_quantities(), std::back_inserter(keys), &LookQuantity::key);
    return keys;
}

const LookQuantity& quantity_named(const std::string& key) {
    return *std::ranges::find(look_quantities(), key, &LookQuantity::key);
}

LookCheck read_check(TomlTable& table, const std::vector<std::string>& variants) {
    LookCheck check{
        .quantity = &quantity_named(table.choice("measure", quantity_keys())), .field_deg = {}, .bound = {}};
    const std::string of = table.choice("of", variants);
    check.variant = static_cast<std::size_t>(std::ranges::find(variants, of) - variants.begin());
    check.field_deg = table.numbers("field_deg", 2, {.min = 0.0, .max = 180.0});
    check.bound = findings::read_bound(table);
    table.finish();
    return check;
}

struct Mean {
    double value = 0.0;
    double standard_error = 0.0;  // by the values' scatter: nobody knows that of one
    std::size_t count = 0;
};

Mean mean_of(const std::vector<double>& values) {
    Mean mean{.count = values.size()};
    const auto n = static_cast<double>(values.size());
    for (const double value : values) {
        mean.value += value / n;
    }
    double square = 0.0;
    for (const double value : values) {
        square += (value - mean.value) * (value - mean.value);
    }
    mean.standard_error =
        values.size() > 1 ? std::sqrt(square / (n * (n - 1.0))) : std::numeric_limits<double>::quiet_NaN();
    return mean;
}

/// Picture less rays, the mean in each of three zones of the field, where noise is less than a feature's: of them the
/// farthest from 0, or one that is not known.
findings::Check agreement(const LookQuantity& quantity, double limit, const VariantFeatures& variant) {
    constexpr std::size_t kZones = 3;
    const std::vector<ChartFeature>& features = variant.features;
    std::optional<Mean> worst;
    for (std::size_t zone = 0; zone < kZones; ++zone) {
        std::vector<double> off;
        for (std::size_t i = zone * features.size() / kZones; i < (zone + 1) * features.size() / kZones; ++i) {
            off.push_back(features[i].picture.*quantity.value - features[i].rays.*quantity.value);
        }
        const Mean mean = mean_of(off);
        const auto is_known = [](const Mean& one) { return std::isfinite(one.value + one.standard_error); };
        if (!worst || !is_known(mean) || (is_known(*worst) && std::abs(mean.value) > std::abs(worst->value))) {
            worst = mean;
        }
    }
    findings::Check check{.group = {}, .label = {}, .explanation = {}};
    check.label = fmt::format("{}, picture against rays: {}", quantity.label, variant.label);
    check.value = worst->value;
    check.sigma = worst->standard_error;
    check.unit = quantity.unit;
    check.limit = limit;
    check.expectation = findings::Expectation::within;
    check.explanation =
        fmt::format("The mean over {} features, in that third of the field where it is farthest from 0.", worst->count);
    return check;
}

findings::Check held(const LookCheck& wanted, const VariantFeatures& variant) {
    std::vector<double> values;
    for (const ChartFeature& feature : variant.features) {
        if (feature.field_deg >= wanted.field_deg[0] && feature.field_deg <= wanted.field_deg[1]) {
            values.push_back(feature.picture.*wanted.quantity->value);
        }
    }
    const Mean mean = mean_of(values);
    findings::Check check{.group = {}, .label = {}, .explanation = {}};
    check.label = fmt::format("{}, {:g}° to {:g}°: {}", wanted.quantity->label, wanted.field_deg[0],
                              wanted.field_deg[1], variant.label);
    check.value = mean.value;
    check.sigma = mean.standard_error;
    check.unit = wanted.quantity->unit;
    check.limit = wanted.bound.limit;
    check.expectation = wanted.bound.expectation;
    check.target = wanted.bound.target;
    check.explanation = fmt::format("The mean over {} features of the picture.", mean.count);
    return check;
}

}  // namespace

MeasuredChart read_measured_chart(TomlTable table, const std::vector<std::string>& variants) {
    MeasuredChart chart{
        .choice = {.objects = table.has("objects") ? table.texts("objects") : std::vector<std::string>{},
                   .is_lamps = table.boolean_or("lamps", false)},
        .agrees = {},
        .checks = {}};
    if (std::optional<TomlTable> agrees = table.optional_table("agrees")) {
        for (const LookQuantity& quantity : look_quantities()) {
            if (agrees->has(quantity.key)) {
                chart.agrees.emplace_back(&quantity, agrees->number(quantity.key, kPositive));
            }
        }
        agrees->finish();
    }
    for (TomlTable& check : table.tables("checks")) {
        chart.checks.push_back(read_check(check, variants));
    }
    if (chart.agrees.empty()) {
        table.fail("agrees",
                   fmt::format("says nothing, expected a limit of some of {}", fmt::join(quantity_keys(), ", ")));
    }
    table.finish();
    return chart;
}

std::vector<findings::Check> chart_checks(const MeasuredChart& chart, const std::string& name, const std::string& title,
                                          const std::vector<VariantFeatures>& variants, findings::Quality quality) {
    // By the root of how many samples fewer a feature has.
    const double wider = quality == findings::Quality::draft
                             ? findings::kDraftShrinks * std::sqrt(static_cast<double>(findings::kDraftSamplesOver))
                             : 1.0;
    std::vector<findings::Check> checks;
    const auto add = [&](findings::Check check, const VariantFeatures& variant) {
        check.id = fmt::format("{}-chart-{}", name, checks.size() + 1);
        check.group = title;
        check.subject = fmt::format("{}-{}", name, variant.name);
        checks.push_back(std::move(check));
    };
    for (const auto& [quantity, limit] : chart.agrees) {
        for (const VariantFeatures& variant : variants) {
            add(agreement(*quantity, wider * limit, variant), variant);
        }
    }
    for (const LookCheck& check : chart.checks) {
        add(held(check, variants[check.variant]), variants[check.variant]);
    }
    return checks;
}

std::vector<findings::Picture> chart_drawings(const MeasuredChart& chart, const std::string& name,
                                              const std::vector<VariantFeatures>& variants) {
    std::vector<findings::Picture> drawings;
    for (const auto& [quantity, limit] : chart.agrees) {
        draw::PlotChart drawing{.title = quantity->label,
                                .caption = "Marks: in the picture. Lines: by the lens's rays",
                                .x = {.label = "Field", .unit = "°"},
                                .y = {.label = quantity->label, .unit = quantity->unit}};
        for (std::size_t v = 0; v < variants.size(); ++v) {
            draw::ChartCurve rays{.colour = draw::series_colour(v), .width = 1.2};
            draw::ChartCurve picture{.label = variants[v].label,
                                     .colour = draw::series_colour(v),
                                     .line = draw::CurveLine::none,
                                     .marker = static_cast<draw::CurveMarker>(1 + v % 5)};
            for (const ChartFeature& feature : variants[v].features) {
                rays.points.push_back({feature.field_deg, feature.rays.*quantity->value});
                picture.points.push_back({feature.field_deg, feature.picture.*quantity->value});
            }
            drawing.curves.push_back(std::move(rays));
            drawing.curves.push_back(std::move(picture));
        }
        constexpr draw::ChartSize kSize{.width = 620.0, .height = 420.0};
        drawings.push_back({.name = fmt::format("{}/{}.svg", name, quantity->key),
                            .caption = quantity->label,
                            .width = kSize.width,
                            .height = kSize.height,
                            .bytes = draw::chart_svg(drawing, kSize)});
    }
    return drawings;
}

Json features_json(const std::vector<ChartFeature>& features) {
    Json list = Json::list();
    for (const ChartFeature& feature : features) {
        Json one{{"field_deg", feature.field_deg}};
        for (const LookQuantity& quantity : look_quantities()) {
            one["picture"][quantity.key] = feature.picture.*quantity.value;
            one["rays"][quantity.key] = feature.rays.*quantity.value;
        }
        list.push_back(std::move(one));
    }
    return list;
}

}  // namespace lensproof::studies
