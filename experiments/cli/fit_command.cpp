// experiments/cli/fit_command.cpp — `lensproof fit PROFILE… --lens LENS`: what is otherwise in a lens than its
// prescription says, by what was measured of it.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

#include "calibration/explain/explanation.h"
#include "engine/base/input_error.h"
#include "engine/base/json.h"
#include "engine/formats/prescription/load_lens.h"
#include "experiments/cli/command.h"
#include "experiments/cli/terminal.h"

namespace lensproof::cli {

namespace {

struct FitOptions {
    CommonOptions common;
    std::vector<std::string> profiles;
    std::string lens;
    std::vector<std::string> free;
    std::optional<double> focus_mm;
};

/// "0.80 gap_4_mm − 0.60 gap_7_mm".
std::string combination_text(const calibration::OpenCombination& open) {
    if (open.direction.size() == 1) {
        return open.direction.front().first;
    }
    std::string text;
    for (const auto& [name, component] : open.direction) {
        text +=
            fmt::format("{}{:.2f} {}", text.empty() ? (component < 0.0 ? "−" : "") : (component < 0.0 ? " − " : " + "),
                        std::abs(component), name);
    }
    return text;
}

void print_parameters(const calibration::LensExplanation& found) {
    print("{:24} {:>10}   {:>9}  {:>9}\n", "parameter", "value", "± error", "tolerance");
    for (const calibration::ExplainedChange& of : found.parameters) {
        print("{:24} {:>10.4g} ± {:<9.2g}  {:<9.2g}{}\n", of.change.name, of.value, of.standard_error,
              of.prior_standard_error, of.determined ? "  determined" : "");
    }
}

/// What the data cannot tell apart, in words: single parameters in one line, combinations in one each.
void print_undetermined(const calibration::LensExplanation& found) {
    std::string untouched;
    for (const calibration::OpenCombination& open : found.undetermined) {
        if (open.direction.size() == 1) {
            untouched += (untouched.empty() ? "" : ", ") + open.direction.front().first;
        }
    }
    if (!untouched.empty()) {
        print("\nThe data say nothing of {}.\n", untouched);
    }
    bool is_first = true;
    for (const calibration::OpenCombination& open : found.undetermined) {
        if (open.direction.size() > 1) {
            if (std::exchange(is_first, false)) {
                print("\nThey cannot tell these apart, changed together by so much (in tolerances):\n");
            }
            print("  ± {:<5.2f} of {}\n", open.standard_error, combination_text(open));
        }
    }
    if (found.suggestion) {
        print("A picture that would tell more: {}; ± {:.2f} of {} would become ± {:.2f}.\n", found.suggestion->picture,
              found.suggestion->about.standard_error, combination_text(found.suggestion->about),
              found.suggestion->with_it);
    }
}

void print_explanation(const std::string& lens, const calibration::LensExplanation& found) {
    print("{}: {}: {}\n", lens, calibration::fit_verdict_name(found.verdict), found.reason);
    if (found.parameters.empty()) {
        return;
    }
    if (!found.cause.empty()) {
        print("what is wrong: {}\n", found.cause);
        for (const std::string& other : found.other_causes) {
            print("  nearly as likely: {}\n", other);
        }
    }
    print("residuals: {:.3g} µm rms as prescribed, {:.3g} µm with the changes; noise {:.3g} µm, {} points\n",
          found.rms_um_before, found.rms_um_after, found.noise_um, found.points);
    print("held-out points: {:.3g} of the noise's variance as prescribed, {:.3g} with the changes\n\n",
          found.held_out.prescribed, found.held_out.changed);
    print_parameters(found);
    print_undetermined(found);
}

Json open_json(const calibration::OpenCombination& open) {
    Json direction = Json::object();
    for (const auto& [name, component] : open.direction) {
        direction[name] = component;
    }
    return Json{{"combination", direction}, {"standard_error", open.standard_error}};
}

Json explanation_json(const FitOptions& options, const calibration::LensExplanation& found) {
    Json parameters = Json::list();
    for (const calibration::ExplainedChange& of : found.parameters) {
        parameters.push_back(Json{{"name", of.change.name},
                                  {"value", of.value},
                                  {"standard_error", of.standard_error},
                                  {"prior_standard_error", of.prior_standard_error},
                                  {"determined", of.determined}});
    }
    Json undetermined = Json::list();
    for (const calibration::OpenCombination& open : found.undetermined) {
        undetermined.push_back(open_json(open));
    }
    Json suggestion;
    if (found.suggestion) {
        suggestion = open_json(found.suggestion->about);
        suggestion["picture"] = found.suggestion->picture;
        suggestion["standard_error_with_it"] = found.suggestion->with_it;
    }
    return Json{{"lens", options.lens},
                {"profiles", options.profiles},
                {"parameters", parameters},
                {"undetermined", undetermined},
                {"residual_rms_um_before", found.rms_um_before},
                {"residual_rms_um_after", found.rms_um_after},
                {"noise_rms_um", found.noise_um},
                {"verdict", calibration::fit_verdict_name(found.verdict)},
                {"reason", found.reason},
                {"cause", found.cause.empty() ? Json() : Json(found.cause)},
                {"other_causes", found.other_causes},
                {"held_out", Json{{"prescribed", found.held_out.prescribed},
                                  {"changed", found.held_out.changed},
                                  {"significance", found.held_out.significance}}},
                {"chi2_per_freedom", found.chi2_per_freedom},
                {"points", found.points},
                {"points_not_imaged", found.points_not_imaged},
                {"suggestion", suggestion}};
}

int run_fit(const FitOptions& options) {
    check_json_name(options.common);
    const optics::Lens lens = formats::load_lens(options.lens);
    print_findings(options.common, lens);
    std::vector<calibration::NamedProfile> profiles;
    for (const std::string& file : options.profiles) {
        profiles.push_back({file, calibration::read_profile(file)});
    }
    calibration::ExplainSettings settings{.focus_mm = options.focus_mm};
    if (!options.free.empty()) {
        settings.free = options.free;
    }
    const calibration::LensExplanation found = calibration::explain(lens, profiles, settings);
    if (prints_text(options.common)) {
        print_explanation(options.lens, found);
    }
    Json json = explanation_json(options, found);
    json["findings"] = findings_json(lens.findings);
    write_json_result(options.common, json);
    return kDone;
}

}  // namespace

void add_fit_command(Program& program) {
    const auto options = std::make_shared<FitOptions>();
    Command command = program.add_command("fit", "Explain a measured profile by small changes of a lens");
    command.footer(
        "Example: lensproof fit profile.json --lens tessar --free focus,gaps,decentre\n"
        "Several profiles, of one camera and lens, are explained by one lens, each with a focus of its own.\n"
        "The verdict is explained, not-this-lens or unexplained; tolerances: calibration/README.md.");
    command.add_option("PROFILE", options->profiles, "Profiles that measure wrote, of a chart's pictures").required();
    command.add_option("--lens", options->lens, "The lens that they are measured of").required().type_name("LENS");
    command
        .add_option("--free", options->free,
                    "What may be otherwise: focus, gaps, decentre, tilt, sensor-tilt, glass (default: all)")
        .separated_by(',')
        .takes_one_argument();
    command
        .add_option(
            "--focus", options->focus_mm,
            "The object's distance from the first surface that the lens is focused on, mm (default: the charts')")
        .check(kPositiveOption)
        .type_name("MM");
    add_common_options(command, options->common);
    command.runs([options] { return run_fit(*options); });
}

}  // namespace lensproof::cli
