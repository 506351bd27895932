// experiments/cli/glasses_command.cpp — `lensproof glasses`: the glasses that are known, and the sheet of one.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <memory>

#include "engine/base/infinity.h"
#include "engine/base/input_error.h"
#include "engine/base/json.h"
#include "engine/base/text.h"
#include "engine/formats/glass/shipped_glasses.h"
#include "engine/optics/air.h"
#include "engine/optics/glass_catalogue.h"
#include "engine/spectral/wavelengths.h"
#include "experiments/cli/command.h"
#include "experiments/cli/terminal.h"

namespace lensproof::cli {

namespace {

struct GlassesOptions {
    CommonOptions common;
    std::vector<std::string> names;
    std::vector<std::string> catalogues;
};

double index_where_covered(const optics::Glass& glass, double wavelength_nm) {
    return optics::covers(glass, wavelength_nm) ? optics::refractive_index(glass.formula, wavelength_nm) : kNaN;
}

/// V_d where the formula reaches from F to C.
double abbe_where_covered(const optics::Glass& glass) {
    return optics::covers(glass, spectral::kLineF) && optics::covers(glass, spectral::kLineC)
               ? optics::abbe_number(glass.formula)
               : kNaN;
}

Json summary(const optics::Glass& glass) {
    return {{"glass", glass.name},
            {"catalogue", glass.catalogue},
            {"n_d", index_where_covered(glass, spectral::kLineD)},
            {"V_d", abbe_where_covered(glass)},
            {"min_wavelength_nm", glass.min_wavelength_nm},
            {"max_wavelength_nm", glass.max_wavelength_nm},
            {"status", glass.status},
            {"source", glass.source},
            {"note", glass.note}};
}

int list_glasses(const GlassesOptions& options, const optics::GlassCatalogue& catalogue) {
    Json glasses = Json::list();
    for (const optics::Glass& glass : catalogue.glasses()) {
        glasses.push_back(summary(glass));
        if (prints_text(options.common)) {
            print("{:12} {:8} n_d {:.5f}  V_d {:5.2f}  {:4.0f} to {:4.0f} nm  {:8}  {}\n", glass.name, glass.catalogue,
                  index_where_covered(glass, spectral::kLineD), abbe_where_covered(glass), glass.min_wavelength_nm,
                  glass.max_wavelength_nm, glass.status, glass.source);
        }
    }
    write_json_result(options.common, {{"glasses", glasses}});
    return kDone;
}

/// The lines of a maker's sheet, from i to t.
Json index_rows(const optics::Glass& glass) {
    Json rows = Json::list();
    for (const spectral::SpectralLine& line : spectral::spectral_lines()) {
        const double n = index_where_covered(glass, line.wavelength_nm);
        const double reference_C = glass.thermal ? glass.thermal->reference_C : 20.0;
        rows.push_back({{"line", line.name},
                        {"wavelength_nm", line.wavelength_nm},
                        {"n", n},
                        {"n_in_vacuum", optics::absolute_index(n, line.wavelength_nm, reference_C)},
                        {"dn_dT_relative_per_K", optics::dn_dT_relative(glass, line.wavelength_nm)},
                        {"dn_dT_absolute_per_K", optics::dn_dT_absolute(glass, line.wavelength_nm)}});
    }
    return rows;
}

Json sheet(const optics::Glass& glass, const std::vector<std::string>& also_in) {
    Json json = summary(glass);
    const bool visible = optics::covers(glass, spectral::kLineG) && optics::covers(glass, spectral::kLineC);
    json["also_in"] = also_in;
    json["stated_n_d"] = glass.stated_n_d;
    json["stated_V_d"] = glass.stated_V_d;
    json["V_e"] = visible ? Json(optics::abbe_number_e(glass.formula)) : nullptr;
    json["P_gF"] =
        visible ? Json(optics::partial_dispersion(glass.formula, spectral::kLineG, spectral::kLineF)) : nullptr;
    json["lines"] = index_rows(glass);
    Json transmittance = Json::list();
    for (const optics::TransmittancePoint& point : formats::shipped_transmittance(glass)) {
        transmittance.push_back({{"wavelength_nm", point.wavelength_nm},
                                 {"internal_transmittance", point.transmittance},
                                 {"thickness_mm", point.thickness_mm}});
    }
    json["internal_transmittance"] = transmittance;
    return json;
}

/// A number of a sheet in a column, or a dash.
std::string cell(const Json& value, double factor, int digits) {
    return value.is_number() ? fmt::format("{:.{}f}", factor * value.number(), digits) : "-";
}

void print_sheet(const Json& json) {
    const auto text = [&](const char* key) { return json[key].text(); };
    print("{} ({}{})\n  {}\n", text("glass"), text("catalogue"), text("status").empty() ? "" : ", " + text("status"),
          text("source"));
    if (!text("note").empty()) {
        print("  {}\n", text("note"));
    }
    std::vector<std::string> also_in;
    std::ranges::transform(json["also_in"], std::back_inserter(also_in), &Json::text);
    if (!also_in.empty()) {
        print("  a glass of this name, with another formula: {}\n", fmt::join(also_in, ", "));
    }
    print("  n_d {}  V_d {}  V_e {}  P_gF {}  {:.0f} to {:.0f} nm\n", cell(json["n_d"], 1.0, 6),
          cell(json["V_d"], 1.0, 2), cell(json["V_e"], 1.0, 2), cell(json["P_gF"], 1.0, 4),
          json["min_wavelength_nm"].number(), json["max_wavelength_nm"].number());
    print("  line         nm   n (in air)  n (vacuum)  dn/dT at 20 °C, 1e-6/K: in air, vacuum\n");
    for (const auto& line : json["lines"]) {
        print("  {:4} {:10.4f}   {:>10}  {:>10}  {:>7} {:>7}\n", line["line"].text(), line["wavelength_nm"].number(),
              cell(line["n"], 1.0, 6), cell(line["n_in_vacuum"], 1.0, 6), cell(line["dn_dT_relative_per_K"], 1e6, 2),
              cell(line["dn_dT_absolute_per_K"], 1e6, 2));
    }
    if (!json["internal_transmittance"].empty()) {
        print("  internal transmittance through {} mm\n ", json["internal_transmittance"][0]["thickness_mm"].number());
        for (const auto& point : json["internal_transmittance"]) {
            print(" {:.0f}:{}", point["wavelength_nm"].number(), cell(point["internal_transmittance"], 1.0, 3));
        }
        print("\n");
    }
}

int show_glasses(const GlassesOptions& options, const optics::GlassCatalogue& catalogue) {
    Json sheets = Json::list();
    for (const std::string& name : options.names) {
        const optics::GlassMatch match = catalogue.resolve(name);
        if (!match.glass) {
            throw InputError(fmt::format("glass \"{}\" is in no catalogue; {}", printable(name),
                                         optics::suggestion_text(match.suggestions)));
        }
        sheets.push_back(sheet(*match.glass, match.also_in));
    }
    if (prints_text(options.common)) {
        for (const auto& json : sheets) {
            print_sheet(json);
        }
    }
    write_json_result(options.common, {{"glasses", sheets}});
    return kDone;
}

}  // namespace

void add_glasses_command(Program& program) {
    const auto options = std::make_shared<GlassesOptions>();
    Command command = program.add_command(
        "glasses", "List the glasses that are known, with their sources, or show the sheets of some");
    command.footer("Example: lensproof glasses N-BK7 \"SCHOTT LAK9\"");
    command.add_option("NAME", options->names, "Glasses to show, as lens people write them");
    add_glass_catalogue_option(command, options->catalogues);
    add_common_options(command, options->common);
    command.runs([options] {
        check_json_name(options->common);
        const optics::GlassCatalogue catalogue = read_glass_catalogues(options->catalogues);
        return options->names.empty() ? list_glasses(*options, catalogue) : show_glasses(*options, catalogue);
    });
}

}  // namespace lensproof::cli
