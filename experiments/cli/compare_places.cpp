#include "experiments/cli/compare_places.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "engine/base/input_error.h"
#include "experiments/cli/pixel_rectangles.h"
#include "experiments/cli/terminal.h"
#include "experiments/draw/chart.h"
#include "experiments/draw/palette.h"
#include "experiments/draw/report/html_text.h"
#include "experiments/findings/shown_picture.h"

namespace lensproof::cli {

namespace {

using calibration::EdgePair;
using calibration::Estimate;
using calibration::LightSpot;
using calibration::SharpnessComparison;
using calibration::SpotPair;

std::string with_error(const Estimate& estimate, const std::string& unit) {
    return draw::measurement_text(estimate.value, estimate.standard_error) + (unit.empty() ? "" : " " + unit);
}

Json level_json(const std::optional<calibration::MtfFrequency>& level) {
    return level ? estimate_json({level->cycles_per_px, level->standard_error}) : Json();
}

Json sharpness_json(const SharpnessComparison& sharpness) {
    Json json{{"channel", sharpness.channel},
              {"edges", sharpness.pairs.size()},
              {"refused", sharpness.refused},
              {"mtf50_ratio", estimate_json(sharpness.mtf50_ratio)},
              {"step_cycles_per_px", calibration::kMtfStep},
              {"a", sharpness.mtf_a},
              {"b", sharpness.mtf_b}};
    std::ranges::transform(sharpness.difference, std::back_inserter(json["difference"]), estimate_json);
    for (const EdgePair& pair : sharpness.pairs) {
        json["pairs"].push_back({{"centre_px", Json::list({pair.a.centre_px.x, pair.a.centre_px.y})},
                                 {"normal_deg", pair.a.normal_deg},
                                 {"mtf50_a", level_json(pair.a.mtf50)},
                                 {"mtf50_b", level_json(pair.b.mtf50)}});
    }
    return json;
}

Json spot_json(const LightSpot& spot, const formats::Image& picture) {
    Json json{{"x_px", estimate_json(spot.x_px)},
              {"y_px", estimate_json(spot.y_px)},
              {"diameter_px", estimate_json(spot.diameter_px)},
              {"elongation", estimate_json(spot.elongation)},
              {"angle_deg", estimate_json(spot.angle_deg)},
              {"clipped_share", spot.clipped_fraction}};
    for (std::size_t c = 0; c < spot.light.size(); ++c) {
        json["light"][picture.channels[c]] = estimate_json(spot.light[c]);
    }
    return json;
}

Json pair_json(const SpotPair& pair, const formats::Image& picture) {
    Json json{{"box", Json::list({pair.box.x, pair.box.y, pair.box.width, pair.box.height})},
              {"a", spot_json(pair.a, picture)},
              {"b", spot_json(pair.b, picture)},
              {"shift_x_px", estimate_json(pair.shift_x_px)},
              {"shift_y_px", estimate_json(pair.shift_y_px)},
              {"diameter_ratio", estimate_json(pair.diameter_ratio)},
              {"light_ev", estimate_json(pair.light_ev)}};
    for (std::size_t c = 0; c < pair.colour_ev.size(); ++c) {
        json["colour_ev"][picture.channels[c]] = estimate_json(pair.colour_ev[c]);
    }
    return json;
}

std::vector<findings::Fact> facts_of(const SpotPair& pair, const std::string& name, const formats::Image& picture) {
    const auto both = [&](const Estimate& a, const Estimate& b, const std::string& unit) {
        return fmt::format("{} in A, {} in B", with_error(a, unit), with_error(b, unit));
    };
    std::vector<findings::Fact> facts = {
        {name + ", centre",
         fmt::format("{}, {} px from A’s", with_error(pair.shift_x_px, ""), with_error(pair.shift_y_px, ""))},
        {name + ", diameter", both(pair.a.diameter_px, pair.b.diameter_px, "px") +
                                  fmt::format("; ratio {}", with_error(pair.diameter_ratio, ""))},
        {name + ", elongation", both(pair.a.elongation, pair.b.elongation, "")},
        {name + ", its direction", both(pair.a.angle_deg, pair.b.angle_deg, "°")},
        {name + ", light", with_error(pair.light_ev, "EV, B against A")}};
    for (std::size_t c = 0; c < pair.colour_ev.size(); ++c) {
        if (picture.channels[c] != "G") {
            facts.push_back({fmt::format("{}, {} over G", name, picture.channels[c]),
                             with_error(pair.colour_ev[c], "EV, B against A")});
        }
    }
    if (const double clipped = std::max(pair.a.clipped_fraction, pair.b.clipped_fraction); clipped > 0.0) {
        facts.push_back(
            {name + ", clipped", fmt::format("{:.2g} % of its pixels in A, {:.2g} % in B: no light or colour to tell",
                                             100.0 * pair.a.clipped_fraction, 100.0 * pair.b.clipped_fraction)});
    }
    return facts;
}

}  // namespace

Json estimate_json(const Estimate& estimate) {
    return {{"value", estimate.value}, {"standard_error", estimate.standard_error}};
}

ComparedPlaces compare_places(const formats::Image& a, const formats::Image& b,
                              const calibration::PictureComparison& found, const calibration::ClippedFrom& clipped,
                              const PictureOptions& options, const std::string& files) {
    ComparedPlaces places;
    const auto named = [&](const std::string& option, const auto& measure) {
        try {
            measure();
        } catch (const InputError& error) {
            throw InputError(fmt::format("{}: {}: {}", files, option, error.what()));
        }
    };
    if (!options.edges.empty()) {
        named("--edge", [&] {
            places.sharpness = calibration::compare_sharpness(a, b, found.registration, parse_edges(options.edges));
        });
    }
    for (const std::string& spot : options.spots) {
        named("--spot", [&] {
            places.spots.push_back(calibration::compare_spots(a, b, found.registration, found.exposure, clipped,
                                                              parse_rectangle("--spot", spot)));
        });
    }
    return places;
}

void add_places_json(const ComparedPlaces& places, const formats::Image& picture, Json& json) {
    if (places.sharpness) {
        json["mtf"] = sharpness_json(*places.sharpness);
    }
    for (const SpotPair& pair : places.spots) {
        json["spots"].push_back(pair_json(pair, picture));
    }
}

std::vector<findings::Fact> place_facts(const ComparedPlaces& places, const formats::Image& picture) {
    std::vector<findings::Fact> facts;
    if (places.sharpness) {
        const SharpnessComparison& sharpness = *places.sharpness;
        facts.push_back({"edges", fmt::format("{} measured in both, in {}; {} refused", sharpness.pairs.size(),
                                              sharpness.channel, sharpness.refused)});
        facts.push_back({"MTF50, B over A", with_error(sharpness.mtf50_ratio, "")});
    }
    for (std::size_t i = 0; i < places.spots.size(); ++i) {
        const std::string name = places.spots.size() == 1 ? "spot" : fmt::format("spot {}", i + 1);
        std::ranges::move(facts_of(places.spots[i], name, picture), std::back_inserter(facts));
    }
    return facts;
}

void print_places(const ComparedPlaces& places, const formats::Image& picture) {
    for (const findings::Fact& fact : place_facts(places, picture)) {
        print("{:32} {}\n", fact.label, fact.value);
    }
}

std::vector<findings::Picture> place_pictures(const ComparedPlaces& places) {
    if (!places.sharpness) {
        return {};
    }
    const SharpnessComparison& sharpness = *places.sharpness;
    draw::PlotChart chart{.title = "Sharpness at the same edges",
                          .caption = fmt::format("{} edges, {}; A's pixels", sharpness.pairs.size(), sharpness.channel),
                          .x = {.label = "Spatial frequency", .unit = "cycles/px"},
                          .y = {.label = "MTF", .holds_zero = true}};
    const auto add = [&](const std::string& label, const std::vector<double>& mtf, std::size_t colour) {
        draw::ChartCurve curve{.label = label, .points = {}, .colour = draw::series_colour(colour)};
        for (std::size_t i = 0; i < mtf.size() && calibration::kMtfStep * static_cast<double>(i) <= 0.5; ++i) {
            curve.points.push_back({calibration::kMtfStep * static_cast<double>(i), mtf[i]});
        }
        chart.curves.push_back(std::move(curve));
    };
    add("A", sharpness.mtf_a, 0);
    add("B", sharpness.mtf_b, 1);
    return {findings::drawn_picture("mtf.svg", "The mean of both pictures' edges",
                                    draw::chart_svg(chart, {.width = 620.0, .height = 400.0}))};
}

}  // namespace lensproof::cli
