// experiments/cli/list_commands.cpp — `lensproof lenses`: the lenses that ship.
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <sstream>

#include "engine/base/angle.h"
#include "engine/base/json.h"
#include "engine/formats/prescription/load_lens.h"
#include "engine/formats/prescription/prescription_file.h"
#include "engine/optics/chief_ray.h"
#include "engine/optics/lens.h"
#include "engine/optics/paraxial.h"
#include "engine/spectral/wavelengths.h"
#include "experiments/cli/command.h"
#include "experiments/cli/terminal.h"

namespace lensproof::cli {

namespace {

/// A lens's figures at one setting, computed from its table at the d line, object at infinity.
struct Figures {
    double efl_mm;
    double bfl_mm;
    double f_number;
    double half_field_deg;  // of the last chief ray that passes every rim
};

Figures figures_of(const optics::Lens& lens) {
    const optics::ParaxialData data = optics::paraxial_data(optics::at_wavelength<double>(lens, spectral::kLineD));
    return {.efl_mm = data.efl,
            .bfl_mm = data.bfl,
            .f_number = data.f_number,
            .half_field_deg = degrees(optics::ChiefRays(lens, spectral::kLineD).largest_field())};
}

void add_figures(Json& json, const Figures& figures) {
    json["efl_mm"] = figures.efl_mm;
    json["bfl_mm"] = figures.bfl_mm;
    json["f_number"] = figures.f_number;
    json["half_field_deg"] = figures.half_field_deg;
}

Json lens_json(const std::string& id, const optics::Prescription& prescription) {
    Json json{{"lens", id}, {"name", prescription.name}};
    add_figures(json, figures_of(formats::load_lens(id)));
    json["projection"] = optics::projection_name(prescription.projection);
    json["source"] = prescription.source;
    json["design"] = prescription.design;
    json["elements"] =
        std::ranges::count_if(prescription.surfaces, [](const auto& row) { return !row.medium.is_air(); });
    json["surfaces"] = prescription.surfaces.size();
    if (prescription.stated.half_field_deg) {
        json["stated_half_field_deg"] = *prescription.stated.half_field_deg;
    }
    for (const optics::ZoomPosition& zoom : prescription.zoom) {
        Json position{{"name", zoom.name}};
        add_figures(position, figures_of(formats::load_lens(id, {.zoom = zoom.name})));
        json["zoom"].push_back(position);
    }
    return json;
}

constexpr std::size_t kTextWidth = 118;
constexpr const char* kIndent = "   ";

/// `text` in lines of at most kTextWidth bytes, broken at spaces, each indented.
std::string indented_lines(const std::string& text) {
    std::string lines;
    std::string line = kIndent;
    std::istringstream words(text);
    for (std::string word; words >> word;) {
        if (line.size() + word.size() > kTextWidth) {
            lines += line + '\n';
            line = kIndent;
        }
        line += ' ' + word;
    }
    return lines + line;
}

void print_figures(const std::string& label, const Json& json, const std::string& rest) {
    print("{:25} {:8.2f} {:8.2f} {:7.2f} {:8.1f}{}\n", label, json["efl_mm"].number(), json["bfl_mm"].number(),
          json["f_number"].number(), json["half_field_deg"].number(), rest);
}

void print_lens(const Json& json) {
    const std::string field =
        json.contains("stated_half_field_deg") ? fmt::format("{:.1f}", json["stated_half_field_deg"].number()) : "–";
    print_figures(json["lens"].text(), json,
                  fmt::format("  {:>6} {:>5}  {:12} {}", field, json["elements"].number(), json["design"].text(),
                              json["projection"].text()));
    for (const Json& position : json["zoom"]) {
        print_figures(fmt::format("{} at {}", kIndent, position["name"].text()), position, "");
    }
    print("{} {}\n", kIndent, json["name"].text());
    show(indented_lines(json["source"].text()) + "\n\n");
}

int list_lenses(const CommonOptions& options) {
    Json lenses = Json::list();
    if (prints_text(options)) {
        print(
            "Computed from each table at the d line, for an object at infinity; field: half, in degrees, of the "
            "last\nchief ray that passes every rim, beside what the source states.\n\n");
        print("{:25} {:>8} {:>8} {:>7} {:>8}  {:>6} {:>5}  {:12} {}\n", "lens", "efl mm", "bfl mm", "f/", "field",
              "stated", "elem.", "design", "projection");
    }
    for (const std::string& name : formats::shipped_lens_names()) {
        lenses.push_back(lens_json(name, formats::read_prescription(formats::find_lens_file(name))));
        if (prints_text(options)) {
            print_lens(lenses.elements().back());
        }
    }
    write_json_result(options, {{"lenses", lenses}});
    return kDone;
}

}  // namespace

void add_lenses_command(Program& program) {
    const auto options = std::make_shared<CommonOptions>();
    Command command = program.add_command("lenses", "List the lenses that ship, with their sources");
    command.footer(
        "The JSON has for each lens: lens, name, efl_mm, bfl_mm, f_number and half_field_deg (of the last\n"
        "chief ray that passes every rim), all computed at the d line for an object at infinity; projection,\n"
        "source, design, elements, surfaces (the stop included), stated_half_field_deg where the source\n"
        "states one, and zoom: the name and the computed figures of each position of a zoom lens, whose\n"
        "own figures are those of the first.\n"
        "Example: lensproof lenses --json -");
    add_common_options(command, *options);
    command.runs([options] {
        check_json_name(*options);
        return list_lenses(*options);
    });
}

}  // namespace lensproof::cli
