#include "experiments/studies/cameras/comparisons.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/base/input_error.h"
#include "experiments/studies/cameras/measured_camera.h"
#include "experiments/studies/cameras/reference_curves.h"

namespace lensproof::studies {

namespace {

struct Comparison {
    std::string of;
    std::string with;
    std::optional<ReferenceSource> reference;  // in place of another camera
    std::string curve;
    std::optional<double> limit;
    findings::Expectation expectation = findings::Expectation::at_most;
};

Comparison read_one(TomlTable& table, const std::set<std::string>& cameras) {
    Comparison comparison;
    for (const auto& [key, name] : {std::pair{"of", &comparison.of}, std::pair{"with", &comparison.with}}) {
        *name = table.text(key);
        if (name == &comparison.with && is_reference(*name)) {
            comparison.reference = read_reference(table, key, *name);
            comparison.with = comparison.reference->label();
        } else if (!cameras.contains(*name)) {
            table.fail(key,
                       fmt::format("is \"{}\", which is neither a simulation nor a photo set of this file", *name));
        }
    }
    comparison.curve = table.choice("curve", calibration::compared_curves());
    comparison.limit = table.optional_number("limit", kPositive);
    if (table.has("expect")) {
        comparison.expectation = table.choice("expect", {"agrees", "differs"}) == "agrees"
                                     ? findings::Expectation::at_most
                                     : findings::Expectation::differs;
    }
    table.finish();
    return comparison;
}

bool is_distortion(const std::string& curve) {
    return curve == calibration::kQuantities.distortion.key() ||
           curve == calibration::kQuantities.equidistant_distortion.key();
}

findings::Check make_check(const Comparison& comparison, const std::optional<calibration::CurveDifference>& difference,
                           std::optional<double> floor) {
    const calibration::ChannelQuantity curve = *calibration::quantity_of(comparison.curve);
    findings::Check check{.id = fmt::format("{}-{}-{}", comparison.of, comparison.with, comparison.curve),
                          .group = "Simulated lenses against the photographed one",
                          .subject = comparison.of,
                          .label = fmt::format("{} against {}: {}, rms", comparison.of, comparison.with,
                                               curve.quantity.title(curve.channel)),
                          .value = std::nan(""),
                          .unit = curve.quantity.unit.symbol,
                          .limit = *comparison.limit,
                          .expectation = comparison.expectation,
                          .explanation = "The curve was not measured in both.",
                          .floor = floor};
    if (difference) {
        check.value = difference->rms;
        check.sigma = difference->rms_sigma;
        check.explanation =
            fmt::format("Over image heights from 0 to {:.2f} of the half-diagonal, where both are covered. {}",
                        difference->curve.covered_image_height,
                        comparison.expectation == findings::Expectation::differs
                            ? "A negative control: these are different lenses, and have to be told apart."
                            : "");
    }
    return check;
}

findings::Findings compare_all(const std::vector<Comparison>& comparisons,
                               const std::vector<calibration::Profile>& profiles) {
    findings::Findings found;
    findings::Plot plot{.id = "comparisons",
                        .title = "Lenses against each other",
                        .subtitle = "distortion, difference of the measured curves",
                        .y_label = "difference",
                        .y_unit = "%"};
    for (const Comparison& comparison : comparisons) {
        const auto profile = [&](const std::string& name) -> const calibration::Profile& {
            const auto named = std::ranges::find(profiles, name, &calibration::Profile::name);
            if (named == profiles.end()) {
                throw InputError(fmt::format("comparisons: {} gave no profile", name));
            }
            return *named;
        };
        const calibration::Profile& of = profile(comparison.of);
        const calibration::Profile with =
            comparison.reference ? reference_curves(*comparison.reference, of, 0.0) : profile(comparison.with);
        const auto difference = calibration::difference(of, with, comparison.curve);
        // Neither measurement knows of the other's error.
        const std::optional<double> one = rms_floor(of, comparison.curve);
        const std::optional<double> other = rms_floor(with, comparison.curve);
        const std::optional<double> floor = one && other ? std::optional(std::hypot(*one, *other)) : std::nullopt;
        if (comparison.reference && !comparison.reference->file.empty()) {
            found.inputs.push_back(comparison.reference->file);
        }
        if (comparison.limit) {
            found.checks.push_back(make_check(comparison, difference, floor));
        }
        if (difference && is_distortion(comparison.curve)) {
            plot.series.push_back({.label = comparison.of + " − " + comparison.with,
                                   .subject = comparison.of,
                                   .style = "difference",
                                   .curve = difference->curve,
                                   .floor = floor});
            plot.limit = comparison.limit;
        }
    }
    found.plots = {std::move(plot)};
    return found;
}

}  // namespace

std::vector<findings::Study> read_comparisons(findings::ExperimentFile& file) {
    std::vector<Comparison> comparisons;
    for (TomlTable& table : file.tables("comparisons")) {
        comparisons.push_back(read_one(table, file.cameras));
    }
    if (comparisons.empty()) {
        return {};
    }
    return {{.name = "comparisons",
             .carry_out = [comparisons = std::move(comparisons)](
                              const findings::RunSettings&, const findings::RunProgress&,
                              const findings::Findings& before) { return compare_all(comparisons, before.profiles); }}};
}

}  // namespace lensproof::studies
