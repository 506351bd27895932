// experiments/cli/check_command.cpp — `lensproof check LENS…`: what is wrong with prescriptions, before any render.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <sstream>

#include "engine/base/input_error.h"
#include "engine/base/json.h"
#include "engine/base/text.h"
#include "engine/base/write_file.h"
#include "engine/check/checker.h"
#include "engine/formats/prescription/load_lens.h"
#include "engine/formats/prescription/prescription_file.h"
#include "experiments/cli/command.h"
#include "experiments/cli/findings_text.h"
#include "experiments/cli/terminal.h"
#include "experiments/draw/lens_section.h"

namespace lensproof::cli {

namespace {

struct CheckOptions {
    CommonOptions common;
    std::vector<std::string> lenses;
    std::string stated;
    std::vector<std::string> indices;
    std::optional<double> wavelength_nm;
    std::string zoom;
    bool manufacture = false;
    std::string plot_file;
    std::vector<std::string> glass_catalogues;
};

double parse_finite(const std::string& text, const std::string& where) {
    const std::optional<double> value = parse_number(text);
    if (!value || !std::isfinite(*value)) {
        throw InputError(fmt::format("{} is \"{}\", expected a number", where, printable(text)));
    }
    return *value;
}

struct Claim {
    const char* key;
    std::optional<double> optics::StatedData::*member;
};

constexpr Claim kClaims[] = {{"efl_mm", &optics::StatedData::efl_mm},
                             {"bfl_mm", &optics::StatedData::bfl_mm},
                             {"f_number", &optics::StatedData::f_number},
                             {"half_field_deg", &optics::StatedData::half_field_deg},
                             {"image_circle_mm", &optics::StatedData::image_circle_mm},
                             {"total_track_mm", &optics::StatedData::total_track_mm}};

/// `efl_mm=100,f_number=2.8`
optics::StatedData parse_claims(const std::string& text) {
    optics::StatedData claims;
    std::istringstream items(text);
    for (std::string item; std::getline(items, item, ',');) {
        const std::size_t equals = item.find('=');
        const std::string key = item.substr(0, equals);
        const auto* claim = std::ranges::find(kClaims, key, &Claim::key);
        if (equals == std::string::npos || claim == std::end(kClaims)) {
            std::vector<std::string> keys;
            std::ranges::transform(kClaims, std::back_inserter(keys), &Claim::key);
            throw InputError(fmt::format("--stated holds \"{}\", expected KEY=NUMBER with one of the keys {}", item,
                                         fmt::join(keys, ", ")));
        }
        const double value = parse_finite(item.substr(equals + 1), "--stated " + key);
        const bool may_be_negative = key == "efl_mm" || key == "bfl_mm";
        if (may_be_negative ? value == 0.0 : !(value > 0.0)) {
            throw InputError(fmt::format("--stated {} is {}, expected a {} number", key, value,
                                         may_be_negative ? "non-zero" : "positive"));
        }
        claims.*claim->member = value;
    }
    return claims;
}

Json computed_json(const check::ComputedData& computed) {
    Json json;
    if (!computed.zoom_position.empty()) {
        json["zoom_position"] = computed.zoom_position;
    }
    const optics::ParaxialData& data = computed.paraxial;
    json["wavelength_nm"] = computed.wavelength_nm;
    json["efl_mm"] = data.efl;
    json["bfl_mm"] = data.bfl;
    json["ffl_mm"] = data.ffl;
    json["entrance_pupil_z_mm"] = data.entrance_pupil_z;
    json["entrance_pupil_diameter_mm"] = data.entrance_pupil_diameter;
    json["exit_pupil_z_mm"] = data.exit_pupil_z;
    json["exit_pupil_diameter_mm"] = data.exit_pupil_diameter;
    json["f_number"] = data.f_number;
    return json;
}

Json report_json(const std::string& lens, const optics::Prescription& prescription, const check::CheckReport& report) {
    Json json{{"lens", lens}, {"file", prescription.file.string()}, {"ok", report.ok()}, {"findings", Json::list()}};
    for (std::size_t i = 0; i < report.findings.size(); ++i) {
        Json finding = finding_json(report.findings[i]);
        finding["section"] = check::section_name(report.section(i));
        json["findings"].push_back(finding);
    }
    if (!report.computed.empty()) {
        json["computed"] = computed_json(report.computed.front());
    }
    if (report.computed.size() > 1) {
        for (const check::ComputedData& computed : report.computed) {
            json["zoom"].push_back(computed_json(computed));
        }
    }
    return json;
}

/// Nothing where nothing was found.
void print_section(const check::CheckReport& report, check::ReportSection section, std::string_view heading) {
    std::vector<optics::Finding> findings;
    for (std::size_t i = 0; i < report.findings.size(); ++i) {
        if (report.section(i) == section) {
            findings.push_back(report.findings[i]);
        }
    }
    if (!findings.empty()) {
        print("{}:\n", heading);
        show(findings_text(findings));
    }
}

void print_report(const std::string& lens, const check::CheckReport& report) {
    const auto count = [&](optics::Severity severity) {
        return std::ranges::count(report.findings, severity, &optics::Finding::severity);
    };
    const auto errors = count(optics::Severity::error);
    const auto warnings = count(optics::Severity::warning);
    print("{}: {} ({} error{}, {} warning{})", lens, report.ok() ? "ok" : "not ok", errors, errors == 1 ? "" : "s",
          warnings, warnings == 1 ? "" : "s");
    if (!report.computed.empty()) {
        const optics::ParaxialData& data = report.computed.front().paraxial;
        print(", focal length {:.4f} mm, back focus {:.4f} mm", data.efl, data.bfl);
        if (std::isfinite(data.f_number)) {
            print(", f/{:.3f}", data.f_number);
        }
    }
    print("\n");
    print_section(report, check::ReportSection::file, "the file as read");
    print_section(report, check::ReportSection::lens, "the lens");
    print_section(report, check::ReportSection::manufacture, "advice for manufacture");
}

/// The section at the position that is checked, or at the first, with what was found there.
void write_plot(const std::string& file, const optics::Prescription& prescription, const optics::StatedData& claims,
                const optics::GlassCatalogue& glasses, check::CheckSettings settings) {
    settings.zoom_position = settings.zoom_position.value_or(0);
    const check::CheckReport report = check::check_prescription(prescription, claims, glasses, settings);
    const optics::Prescription drawn = optics::at_zoom_position(prescription, *settings.zoom_position);
    std::optional<optics::Lens> lens;
    try {
        lens = optics::make_lens(formats::with_stop_picture(drawn), glasses, settings.indices);
    } catch (const InputError&) {
        lens.reset();  // the findings say why; what the table gives is drawn all the same
    }
    write_file(file, draw::lens_section_svg(drawn, lens ? &*lens : nullptr, report.findings));
}

int run_check(const CheckOptions& options) {
    check_json_name(options.common);
    if (!options.plot_file.empty()) {
        check_output_name(options.plot_file);
        if (options.lenses.size() > 1) {
            throw InputError(fmt::format("--plot draws one lens, found {}", options.lenses.size()));
        }
    }
    const optics::StatedData claims = parse_claims(options.stated);
    const optics::IndexOverrides indices = parse_indices(options.indices);
    const optics::GlassCatalogue glasses = read_glass_catalogues(options.glass_catalogues);
    // All are read before any is judged: a file that cannot be read ends the command before it has said anything.
    std::vector<optics::Prescription> prescriptions;
    std::vector<check::CheckSettings> settings;
    for (const std::string& lens : options.lenses) {
        prescriptions.push_back(formats::read_prescription(formats::find_lens_file(lens)));
        settings.push_back({.wavelength_nm = options.wavelength_nm,
                            .indices = indices,
                            .zoom_position = {},
                            .manufacture = options.manufacture});
        if (!options.zoom.empty()) {
            settings.back().zoom_position = optics::find_zoom_position(prescriptions.back(), options.zoom);
        }
    }
    Json lenses = Json::list();
    bool all_ok = true;
    for (std::size_t i = 0; i < prescriptions.size(); ++i) {
        const optics::GlassCatalogue own = formats::with_own_catalogues(glasses, prescriptions[i]);
        const check::CheckReport report = check::check_prescription(prescriptions[i], claims, own, settings[i]);
        all_ok = all_ok && report.ok();
        lenses.push_back(report_json(options.lenses[i], prescriptions[i], report));
        if (prints_text(options.common)) {
            print_report(options.lenses[i], report);
        }
        if (!options.plot_file.empty()) {
            write_plot(options.plot_file, prescriptions[i], claims, own, settings[i]);
        }
    }
    write_json_result(options.common, {{"lenses", lenses}});
    return all_ok ? kDone : kCheckFailed;
}

}  // namespace

void add_check_command(Program& program) {
    const auto options = std::make_shared<CheckOptions>();
    Command command = program.add_command("check", "Say what is wrong with prescriptions");
    command.footer(
        "Example: lensproof check tessar my.zmx --stated efl_mm=100,f_number=2.8 --json -\n"
        "What is found stands in three sections: the file as read (remarks of its reader), the lens (what makes it "
        "another than was meant, or none), and advice for manufacture (with --manufacture). What many surfaces share "
        "is one line; the JSON has each by itself, with its \"section\": file, lens or manufacture.\n"
        "Exit status 1 when any finding is an error; 2 when any file cannot be read, and then none is judged.");
    command.add_option("LENS", options->lenses, "Prescription files, or names of lenses that ship").required();
    command
        .add_option("--stated", options->stated,
                    "What the source claims where the file is silent or wrong: efl_mm, bfl_mm, f_number, "
                    "half_field_deg, image_circle_mm, total_track_mm (of each lens; of a zoom, at each position)")
        .type_name("KEY=NUMBER,…");
    add_index_option(command, options->indices);
    command
        .add_option(
            "--wavelength", options->wavelength_nm,
            "nm, of first-order data and rays (default: the reference of a design program's file, else 587.5618)")
        .check(kPositiveOption);
    command.add_option("--zoom", options->zoom, "Check this zoom position alone (default: every one)")
        .type_name("NAME|N");
    command.add_flag("--manufacture", options->manufacture,
                     "Hold customs of manufacture against them, too, as infos: steep and nearly flat surfaces, thin "
                     "centres and edges, narrow air gaps, centring");
    command.add_option("--plot", options->plot_file, "Draw the lens's section, with what was found marked")
        .type_name("OUT.svg");
    add_glass_catalogue_option(command, options->glass_catalogues);
    add_common_options(command, options->common);
    command.runs([options] { return run_check(*options); });
}

}  // namespace lensproof::cli
