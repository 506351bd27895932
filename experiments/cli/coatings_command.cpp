// experiments/cli/coatings_command.cpp — `lensproof coatings`: the coatings that ship, or that a file states, and what
// they reflect.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>

#include "engine/analysis/coating_curves.h"
#include "engine/base/file.h"
#include "engine/base/input_error.h"
#include "engine/base/text.h"
#include "engine/formats/prescription/shipped_coatings.h"
#include "experiments/cli/command.h"
#include "experiments/cli/terminal.h"
#include "experiments/draw/coating_plots.h"

namespace lensproof::cli {

namespace {

struct CoatingsOptions {
    CommonOptions common;
    std::vector<std::string> names;
    std::string glass = "N-BK7";
    std::vector<std::string> glass_catalogues;
    std::string plots_folder;
    std::vector<double> angles_deg;
    std::vector<double> wavelengths_nm;
};

constexpr double kDesignNm = 550.0;
constexpr double kPercent = 100.0;
constexpr double kLargestIndex = 10.0;  // as a layer's

/// A name of one that ships, or a file.
formats::NamedCoating find_coating(const std::string& name) {
    if (formats::is_shipped_coating(name)) {
        return formats::shipped_coating(name);
    }
    if (!is_there(name)) {
        throw InputError(fmt::format("{}: neither a file nor a coating that ships{}", printable(name),
                                     formats::coating_hint(name, {})));
    }
    return formats::read_coating_file(name);
}

/// A coating with its materials looked up, on a face of the glass; light comes from air.
struct Looked {
    formats::NamedCoating stated;
    analysis::CoatedFace face;
};

Json layers_json(const Looked& coating) {
    Json layers = Json::list();
    const auto* stack = std::get_if<optics::LayerStack>(&coating.stated.coating);
    const auto* films = std::get_if<std::vector<optics::ThinFilm>>(&coating.face.coating);
    for (std::size_t i = 0; stack != nullptr && i < films->size(); ++i) {
        const optics::TraceCoating<double> at =
            optics::coating_at(std::vector{(*films)[i]}, kDesignNm, coating.stated.file.string());
        const std::string& material = stack->layers[i].material;
        layers.push_back({{"material", material.empty() ? Json(nullptr) : Json(material)},
                          {"n_at_550_nm", at.layers.front().index},
                          {"k_at_550_nm", at.layers.front().extinction},
                          {"thickness_nm", (*films)[i].thickness_nm}});
    }
    return layers;
}

Json points_json(const std::vector<Vec2d>& points) {
    Json list = Json::list();
    for (const Vec2d& point : points) {
        list.push_back({point.x, point.y});
    }
    return list;
}

/// The curves of the plots.
void add_curves(Json& json, const analysis::CoatingCurves& curves) {
    json["spectra"] = Json::list();
    for (const analysis::ReflectanceSpectrum& of : curves.spectra) {
        json["spectra"].push_back(
            {{"angle_deg", of.angle_deg}, {"nm_and_reflectance_percent", points_json(of.points)}});
    }
    json["angles"] = Json::list();
    for (const analysis::ReflectanceByAngle& of : curves.angles) {
        json["angles"].push_back({{"wavelength_nm", of.wavelength_nm},
                                  {"deg_and_reflectance_percent", points_json(of.unpolarised)},
                                  {"deg_and_s_percent", points_json(of.s)},
                                  {"deg_and_p_percent", points_json(of.p)}});
    }
}

/// What becomes of each polarisation's power at the angles asked for, from air and from the glass.
Json powers_json(const Looked& coating, const CoatingsOptions& options) {
    using analysis::FaceSide;
    const auto json = [](const optics::CoatedPowers<double>& of) -> Json {
        return {{"reflectance", of.reflected}, {"transmittance", of.transmitted}, {"absorptance", of.absorbed()}};
    };
    const std::vector<double> reference{kDesignNm};
    Json list = Json::list();
    for (const double nm : options.wavelengths_nm.empty() ? reference : options.wavelengths_nm) {
        for (const double angle_deg : options.angles_deg) {
            for (const FaceSide from : {FaceSide::air, FaceSide::glass}) {
                const auto [s, p] = analysis::coated_powers(coating.face, nm, angle_deg, from);
                list.push_back({{"wavelength_nm", nm},
                                {"angle_deg", angle_deg},
                                {"from", from == FaceSide::air ? "air" : "glass"},
                                {"s", json(s)},
                                {"p", json(p)}});
            }
        }
    }
    return list;
}

Json coating_json(const Looked& coating, const std::string& glass) {
    const optics::CoatedPowers<double> at = analysis::coated_powers(coating.face, kDesignNm, 0.0).unpolarised();
    return {{"coating", coating.stated.id},
            {"name", coating.stated.name},
            {"source", coating.stated.source},
            {"notes", coating.stated.notes},
            {"file", coating.stated.file.string()},
            {"layers", layers_json(coating)},
            {"glass", glass},
            {"reflectance_at_550_nm_percent", kPercent * at.reflected},
            {"absorptance_at_550_nm_percent", kPercent * at.absorbed()},
            {"mean_reflectance_400_to_700_nm_percent", kPercent * analysis::mean_reflectance(coating.face)}};
}

void print_coating(const Json& json) {
    print("{:22} {:>6} {:>9.4f} {:>9.4f}   {}\n", json["coating"].text(), json["layers"].size(),
          json["reflectance_at_550_nm_percent"].number(), json["mean_reflectance_400_to_700_nm_percent"].number(),
          json["name"].text());
    for (const Json& layer : json["layers"]) {
        const std::string material = layer["material"].is_null() ? "" : layer["material"].text();
        print("{:22}   {:8} n {:.4f}  k {:<9.2g} {:8.3f} nm\n", "", material, layer["n_at_550_nm"].number(),
              layer["k_at_550_nm"].number(), layer["thickness_nm"].number());
    }
    print("    {}\n", json["source"].text());
    if (json.contains("powers")) {
        print("    {:>8} {:>7} {:>6}   {:>9} {:>9} {:>9}   {:>9} {:>9} {:>9}\n", "nm", "deg", "from", "R s %", "T s %",
              "A s %", "R p %", "T p %", "A p %");
        for (const Json& at : json["powers"]) {
            const auto percent = [&](const char* polarisation, const char* of) {
                return kPercent * at[polarisation][of].number();
            };
            print("    {:>8} {:>7} {:>6}   {:9.4f} {:9.4f} {:9.4f}   {:9.4f} {:9.4f} {:9.4f}\n",
                  at["wavelength_nm"].number(), at["angle_deg"].number(), at["from"].text(),
                  percent("s", "reflectance"), percent("s", "transmittance"), percent("s", "absorptance"),
                  percent("p", "reflectance"), percent("p", "transmittance"), percent("p", "absorptance"));
        }
    }
}

/// A glass that a catalogue has, or one of an index that is said as it is.
optics::Glass find_glass(const CoatingsOptions& options, const optics::GlassCatalogue& catalogue) {
    if (const std::optional<double> index = parse_number(options.glass)) {
        if (!(*index >= 1.0 && *index <= kLargestIndex)) {
            throw InputError(
                fmt::format("--on is {}, expected a glass, or an index from 1 to {}", *index, kLargestIndex));
        }
        return optics::constant_glass(fmt::format("n = {}", *index), *index);
    }
    const optics::GlassMatch match = catalogue.resolve(options.glass);
    if (!match.glass) {
        throw InputError(fmt::format("--on {}: no catalogue has this glass; {}", printable(options.glass),
                                     optics::suggestion_text(match.suggestions)));
    }
    return *match.glass;
}

void check_angles(const CoatingsOptions& options) {
    for (const double angle_deg : options.angles_deg) {
        if (!(angle_deg >= 0.0 && angle_deg < 90.0)) {
            throw InputError(fmt::format("--angles holds {}, expected degrees from 0 to below 90", angle_deg));
        }
    }
    if (options.angles_deg.empty() && !options.wavelengths_nm.empty()) {
        throw InputError("--wavelengths stands without --angles, which it is for");
    }
}

int run_coatings(const CoatingsOptions& options) {
    check_json_name(options.common);
    check_angles(options);
    if (!options.plots_folder.empty()) {
        check_output_name(std::filesystem::path(options.plots_folder) / "coating.svg");
    }
    const optics::GlassCatalogue catalogue = read_glass_catalogues(options.glass_catalogues);
    const optics::Glass air = optics::constant_glass("air", 1.0);
    const analysis::CoatedFace bare{.coating = {}, .glass = find_glass(options, catalogue), .where = "(bare)"};
    const std::string& glass_name = bare.glass.name;
    std::vector<Looked> coatings;
    for (const std::string& name : options.names.empty() ? formats::shipped_coating_names() : options.names) {
        Looked coating{.stated = find_coating(name), .face = bare};
        coating.face.where = coating.stated.file.string();
        coating.face.coating =
            optics::resolved_coating(coating.stated.coating, catalogue, air, bare.glass, coating.face.where);
        coatings.push_back(std::move(coating));
    }
    Json list = Json::list();
    std::map<std::string, std::string> drawings;
    for (const Looked& coating : coatings) {
        Json json = coating_json(coating, glass_name);
        const draw::PlotHeading heading{.lens = coating.stated.name, .conditions = "on " + glass_name};
        if (!options.names.empty() || !options.plots_folder.empty()) {
            const analysis::CoatingCurves curves = analysis::coating_curves(coating.face);
            add_curves(json, curves);
            drawings[coating.stated.id + "-wavelength.svg"] =
                draw::reflectance_spectrum_svg(heading, curves, analysis::coating_curves(bare));
            drawings[coating.stated.id + "-angle.svg"] = draw::reflectance_by_angle_svg(heading, curves);
        }
        if (!options.angles_deg.empty()) {
            json["powers"] = powers_json(coating, options);
        }
        list.push_back(std::move(json));
    }
    if (!options.plots_folder.empty()) {
        draw::write_plots(options.plots_folder, drawings);
    }
    const double bare_at = kPercent * analysis::coated_powers(bare, kDesignNm, 0.0).unpolarised().reflected;
    const double bare_mean = kPercent * analysis::mean_reflectance(bare);
    if (prints_text(options.common)) {
        print(
            "Reflectance in % of a face of {} in air at normal incidence: at 550 nm, and the mean from 400 to 700 nm.\n"
            "Layers from air to glass. Makers do not publish theirs: on any lens these are assumed.\n\n"
            "{:22} {:>6} {:>9} {:>9}\n{:22} {:>6} {:>9.4f} {:>9.4f}\n",
            glass_name, "coating", "layers", "550 nm", "mean", "(bare)", 0, bare_at, bare_mean);
        for (const Json& json : list) {
            print_coating(json);
        }
    }
    write_json_result(options.common, {{"glass", glass_name},
                                       {"bare_reflectance_at_550_nm_percent", bare_at},
                                       {"bare_mean_reflectance_400_to_700_nm_percent", bare_mean},
                                       {"coatings", list}});
    return kDone;
}

}  // namespace

void add_coatings_command(Program& program) {
    const auto options = std::make_shared<CoatingsOptions>();
    Command command = program.add_command("coatings", "List the coatings that ship, with sources and reflectance");
    command.footer(
        "A file of a coating has name, source, notes, and the keys of a lens's table [coatings.NAME].\n"
        "Example: lensproof coatings mgf2 broadband --plots coating-plots\n"
        "Both polarisations: lensproof coatings mgf2 --on SF6 --angles 0,30,60 --wavelengths 450,550");
    command.add_option("COATING", options->names, "Coatings that ship, or files (default: all that ship)");
    command.add_option("--on", options->glass, "The glass that they lie on, or its index")
        .type_name("GLASS")
        .shows_default();
    command
        .add_option("--angles", options->angles_deg,
                    "Say reflectance, transmittance and absorptance of either polarisation at these angles of "
                    "incidence, from air and from the glass")
        .check(kNumberOption)
        .separated_by(',')
        .type_name("DEG,…");
    command.add_option("--wavelengths", options->wavelengths_nm, "There, nm (default: 550)")
        .check(kPositiveOption)
        .separated_by(',')
        .type_name("NM,…");
    command
        .add_option("--plots", options->plots_folder,
                    "Draw reflectance against wavelength and against angle into a folder, two files a coating (SVG)")
        .type_name("DIR");
    add_glass_catalogue_option(command, options->glass_catalogues);
    add_common_options(command, options->common);
    command.runs([options] { return run_coatings(*options); });
}

}  // namespace lensproof::cli
