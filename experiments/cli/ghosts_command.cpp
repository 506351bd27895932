// experiments/cli/ghosts_command.cpp — `lensproof ghosts LENS`: the reflections that reach the sensor, and which
// surface to coat.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

#include "engine/analysis/ghosts.h"
#include "engine/base/angle.h"
#include "engine/base/input_error.h"
#include "engine/base/write_file.h"
#include "experiments/cli/command.h"
#include "experiments/cli/device_option.h"
#include "experiments/cli/findings_text.h"
#include "experiments/cli/ghost_image.h"
#include "experiments/cli/ghost_options.h"
#include "experiments/cli/lens_options.h"
#include "experiments/cli/terminal.h"
#include "experiments/draw/ghost_plot.h"

namespace lensproof::cli {

namespace {

struct GhostsOptions {
    CommonOptions common;
    LensOptions lens;
    MirrorOptions mirrors;
    std::optional<double> source_deg;
    std::string reflections = "2";
    std::optional<int> strongest;
    double tolerance = analysis::GhostSettings{}.tolerance;
    bool polarised = false;
    std::optional<double> image_circle_mm;
    std::string plot_file;
    GhostImageOptions image;
    std::string device = "cpu";
};

analysis::GhostSettings settings_of(const GhostsOptions& options, const AnalysedLens& analysed) {
    const double source_deg = options.source_deg.value_or(0.0);
    if (!(std::abs(source_deg) < 90.0)) {
        throw InputError(
            fmt::format("--source-deg is {}, expected degrees between -90 and 90: energies are shares of "
                        "the light that enters the entrance pupil, a disc that light from beyond does "
                        "not enter",
                        source_deg));
    }
    analysis::GhostSettings settings{
        .reference_wavelength_nm = analysed.settings.reference_wavelength_nm,
        .wavelengths_nm = {},
        .source_angle = source_deg * kDegree,
        .chief_angle = options.source_deg.value_or(analysis::largest_field_deg(analysed.settings)) * kDegree,
        .reflections = options.reflections == "4" ? 4 : 2,
        .tolerance = options.tolerance,
        .mirrors = stray_mirrors(options.mirrors),
        .polarised = options.polarised,
        .sampling = {.seed = options.common.seed},
        .threads = options.common.threads,
        .device = shared_device(options.device, OnRefusal::end)};
    for (const double wavelength_nm : analysed.settings.wavelengths_nm) {
        if (wavelength_nm != settings.reference_wavelength_nm) {
            settings.wavelengths_nm.push_back(wavelength_nm);
        }
    }
    const std::optional<double> radius = options.image_circle_mm
                                             ? std::optional(0.5 * *options.image_circle_mm)
                                             : analysis::image_radius(analysed.lens, settings.reference_wavelength_nm);
    if (!radius) {
        throw InputError(
            fmt::format("{}: neither does the source state an image circle nor does a chief ray reach the "
                        "sensor, expected --image-circle MM",
                        analysed.lens.name));
    }
    settings.image_radius = *radius;
    return settings;
}

Json surface_json(const optics::Lens& lens, int surface) {
    return surface == static_cast<int>(lens.surfaces.size()) ? Json(kSensorName) : Json(surface + 1);
}

std::string path_text(const optics::Lens& lens, const optics::GhostPath& path) {
    std::string text;
    for (const int surface : path) {
        text += text.empty() ? "" : ",";
        text += surface == static_cast<int>(lens.surfaces.size()) ? kSensorName : std::to_string(surface + 1);
    }
    return text;
}

Json ghost_json(const optics::Lens& lens, const analysis::GhostSettings& settings, const analysis::Ghost& ghost) {
    const analysis::GhostLight& light = ghost.light;
    const bool lands = light.energy > 0.0;
    Json surfaces = Json::list();
    for (const int surface : ghost.path) {
        surfaces.push_back(surface_json(lens, surface));
    }
    Json wavelengths = Json::list();
    wavelengths.push_back({{"wavelength_nm", settings.reference_wavelength_nm}, {"energy", light.energy}});
    for (std::size_t i = 0; i < ghost.energies.size(); ++i) {
        wavelengths.push_back({{"wavelength_nm", settings.wavelengths_nm[i]}, {"energy", ghost.energies[i]}});
    }
    return {{"surfaces", std::move(surfaces)},
            {"paraxial",
             {{"marginal_ray_height_mm", ghost.paraxial.marginal_ray_height},
              {"chief_ray_height_mm",
               ghost.paraxial.chief_ray_height ? Json(*ghost.paraxial.chief_ray_height + 0.0) : Json(nullptr)},
              {"efl_mm", ghost.paraxial.efl},
              {"focus_mm", ghost.paraxial.focus},
              {"pupil_mm", ghost.paraxial.pupil},
              {"f_number", ghost.paraxial.f_number}}},
            {"energy", light.energy},
            {"energy_standard_error", light.standard_error},
            {"polarised_energy", settings.polarised ? Json(ghost.polarised_energy) : Json(nullptr)},
            {"wavelengths", std::move(wavelengths)},
            {"centroid_mm", lands ? Json{light.centroid.x, light.centroid.y} : Json(nullptr)},
            {"rms_radius_mm", lands ? Json(light.rms_radius) : Json(nullptr)},
            {"peak_over_image", ghost.peak_over_image ? Json(*ghost.peak_over_image) : Json(nullptr)},
            {"landed_share", lands ? Json(static_cast<double>(light.landed) / light.rays) : Json(nullptr)},
            {"rays", light.rays}};
}

/// How many of the ghosts are listed.
std::size_t listed(const GhostsOptions& options, const analysis::GhostSurvey& survey) {
    const std::size_t all = survey.ghosts.size();
    return options.strongest ? std::min(all, static_cast<std::size_t>(*options.strongest)) : all;
}

Json survey_json(const GhostsOptions& options, const optics::Lens& lens, const analysis::GhostSettings& settings,
                 const analysis::GhostSurvey& survey) {
    Json ghosts = Json::list();
    for (std::size_t i = 0; i < listed(options, survey); ++i) {
        ghosts.push_back(ghost_json(lens, settings, survey.ghosts[i]));
    }
    Json surfaces = Json::list();
    for (const analysis::SurfaceContribution& contribution : survey.surfaces) {
        surfaces.push_back(
            {{"surface", surface_json(lens, contribution.surface)},
             {"share", contribution.involved},
             {"gone_if_perfect", contribution.perfect},
             {"gone_if_mgf2", contribution.quarter_wave ? Json(*contribution.quarter_wave) : Json(nullptr)}});
    }
    return {{"lens", lens.id},
            {"findings", findings_json(lens.findings)},
            {"reference_wavelength_nm", settings.reference_wavelength_nm},
            {"source_deg", settings.source_angle / kDegree},
            {"image_circle_mm", 2.0 * settings.image_radius},
            {"ghosts", std::move(ghosts)},
            {"energy", survey.energy},
            {"polarised_energy", settings.polarised ? Json(survey.polarised_energy) : Json(nullptr)},
            {"image_energy", survey.image.energy},
            {"surfaces", std::move(surfaces)},
            {"skipped_energy_bound", survey.skipped_energy_bound}};
}

std::string ghost_row(const optics::Lens& lens, const analysis::Ghost& ghost) {
    const analysis::GhostLight& light = ghost.light;
    std::string row = fmt::format("{:>14}{:>11.3g}", path_text(lens, ghost.path), light.energy);
    if (light.energy > 0.0) {
        row += fmt::format("{:>8}{:>10}{:>9.2f}{:>9.2f}{:>9.2f}{:>8.0f}",
                           fmt::format("{:.2g} %", 100.0 * light.standard_error / light.energy),
                           ghost.peak_over_image ? fmt::format("{:.3g}", *ghost.peak_over_image) : "-",
                           light.centroid.x + 0.0, light.centroid.y + 0.0, light.rms_radius,
                           100.0 * light.landed / light.rays);
    } else {
        row += fmt::format("{:>8}{:>10}{:>9}{:>9}{:>9}{:>8}", "-", "-", "-", "-", "-", "-");
    }
    return row + fmt::format("{:>11.4g}{:>11.4g}{:>11.4g}\n", ghost.paraxial.focus, ghost.paraxial.pupil,
                             ghost.paraxial.marginal_ray_height);
}

std::string survey_text(const GhostsOptions& options, const optics::Lens& lens, const analysis::GhostSettings& settings,
                        const analysis::GhostSurvey& survey) {
    std::string text =
        fmt::format("{} at {:g} nm, a distant light {:g}° from the axis, image circle {:.4g} mm\n", lens.name,
                    settings.reference_wavelength_nm, settings.source_angle / kDegree, 2.0 * settings.image_radius);
    text += findings_text(lens.findings);
    text += fmt::format("{:>14}{:>11}{:>8}{:>10}{:>9}{:>9}{:>9}{:>8}{:>11}{:>11}{:>11}\n", "reflected at", "energy",
                        "± rms", "peak", "x mm", "y mm", "rms mm", "land %", "focus mm", "pupil mm", "margin. mm");
    for (std::size_t i = 0; i < listed(options, survey); ++i) {
        text += ghost_row(lens, survey.ghosts[i]);
    }
    text += fmt::format("{} ghosts, together {:.3g} of the light that enters the entrance pupil; its image {:.3g}",
                        survey.ghosts.size(), survey.energy, survey.image.energy);
    text += settings.reflections == 4 ? fmt::format("; skipped, at most {:.3g}\n", survey.skipped_energy_bound) : "\n";
    if (settings.polarised) {
        text += fmt::format("with polarisation carried along their paths: {:.3g}, {:+.2f} %\n", survey.polarised_energy,
                            100.0 * (survey.polarised_energy / survey.energy - 1.0));
    }
    text += "\nWhich surface to coat: what of the ghosts' light goes with it\n";
    text += fmt::format("{:>14}{:>11}{:>14}{:>14}\n", "surface", "involved", "perfectly", "MgF2");
    for (const analysis::SurfaceContribution& contribution : survey.surfaces) {
        text += fmt::format(
            "{:>14}{:>9.1f} %{:>12.1f} %{:>14}\n", path_text(lens, {contribution.surface}),
            100.0 * contribution.involved, 100.0 * contribution.perfect,
            contribution.quarter_wave ? fmt::format("{:.1f} %", 100.0 * *contribution.quarter_wave) : std::string("-"));
    }
    return text;
}

void write_plot(const GhostsOptions& options, const AnalysedLens& analysed, const analysis::GhostSettings& settings,
                const analysis::GhostSurvey& survey) {
    constexpr std::size_t kMostDrawn = 8;
    const optics::Lens& lens = analysed.lens;
    const analysis::GhostScene scene = analysis::ghost_scene(lens, settings, settings.reference_wavelength_nm);
    std::vector<draw::DrawnGhost> drawn;
    for (std::size_t i = 0; i < std::min(kMostDrawn, listed(options, survey)); ++i) {
        const analysis::Ghost& ghost = survey.ghosts[i];
        if (!(ghost.light.energy > 0.0)) {
            break;
        }
        drawn.push_back(
            {ghost.path, path_text(lens, ghost.path), ghost.light.energy, analysis::Footprint(settings.image_radius)});
        analysis::measure_ghost(scene, ghost.path, analysis::ghost_region(scene, ghost.path), settings.sampling,
                                &drawn.back().footprint);
    }
    const std::string conditions =
        fmt::format("a distant light {:g}° from the axis, {:g} nm, image circle {:.4g} mm",
                    settings.source_angle / kDegree, settings.reference_wavelength_nm, 2.0 * settings.image_radius);
    write_file(options.plot_file, draw::ghosts_svg(analysed.prescription, lens, scene, conditions, drawn));
}

/// Of how many ghosts a picture of their own is asked for.
std::size_t layers_wanted(const GhostsOptions& options) {
    constexpr int kUsual = 8;
    return static_cast<std::size_t>(options.strongest.value_or(kUsual));
}

/// Of the picture that --image asks for.
analysis::PictureSettings picture_of(const GhostsOptions& options, const analysis::GhostSettings& settings,
                                     std::size_t layers) {
    std::vector<double> wavelengths_nm = settings.wavelengths_nm;
    wavelengths_nm.push_back(settings.reference_wavelength_nm);
    return picture_settings(options.image, 2.0 * settings.image_radius, wavelengths_nm, layers);
}

void write_image(const GhostsOptions& options, const optics::Lens& lens, const analysis::GhostSettings& settings,
                 const analysis::GhostSurvey& survey) {
    const std::size_t separate = std::min(layers_wanted(options), survey.ghosts.size());
    const analysis::PictureSettings picture = picture_of(options, settings, separate);
    std::vector<optics::GhostPath> paths;
    std::vector<GhostLayer> layers;
    for (const analysis::Ghost& ghost : survey.ghosts) {
        paths.push_back(ghost.path);
        if (layers.size() < separate) {
            layers.push_back({path_text(lens, ghost.path), ghost_json(lens, settings, ghost).dump()});
        }
    }
    const Json about{{"lens", lens.id}, {"source_deg", settings.source_angle / kDegree}, {"energy", survey.energy}};
    const double pupil_area = analysis::ghost_scene(lens, settings, settings.reference_wavelength_nm).pupil_area;
    write_ghost_image(options.image.file, picture, pupil_area,
                      analysis::draw_ghosts(lens, settings, picture, paths, separate), about.dump(), layers);
}

int run_ghosts(const GhostsOptions& options) {
    check_json_name(options.common);
    if (!options.plot_file.empty()) {
        check_output_name(options.plot_file);
    }
    const AnalysedLens analysed = read_analysed_lens(options.lens);
    const analysis::GhostSettings settings = settings_of(options, analysed);
    if (!options.image.file.empty()) {
        check_output_name(options.image.file);
        const std::size_t surfaces = analysed.lens.surfaces.size() + 1;
        picture_of(options, settings, std::min(layers_wanted(options), surfaces * surfaces));
    }
    const analysis::GhostSurvey survey = analysis::survey_ghosts(analysed.lens, settings);
    if (!options.image.file.empty()) {
        write_image(options, analysed.lens, settings, survey);
    }
    if (!options.plot_file.empty()) {
        write_plot(options, analysed, settings, survey);
    }
    if (prints_text(options.common)) {
        show(survey_text(options, analysed.lens, settings, survey));
    }
    write_json_result(options.common, survey_json(options, analysed.lens, settings, survey));
    return kDone;
}

}  // namespace

void add_ghosts_command(Program& program) {
    const auto options = std::make_shared<GhostsOptions>();
    Command command = program.add_command("ghosts", "Reflections that reach the sensor, and which surface to coat");
    command.footer(
        "Example: lensproof ghosts tessar --source-deg 10 --strongest 8\n"
        "Energies are shares of the light that enters the entrance pupil; peak is a ghost's brightest place over that "
        "of the light's image.");
    add_lens_options(command, options->lens);
    command
        .add_option("--source-deg", options->source_deg,
                    "Field angle of a distant light (default: 0; of the paraxial chief rays, the largest field)")
        .check(kNumberOption)
        .type_name("A");
    command
        .add_option("--reflections", options->reflections,
                    "2, or 4: those of four as well, as far as they may carry --tolerance")
        .check(one_of({"2", "4"}))
        .shows_default();
    command
        .add_option("--tolerance", options->tolerance,
                    "Ghosts of four reflections that carry less are skipped, and their bounds summed up")
        .check(kPositiveOption)
        .shows_default();
    command.add_option("--strongest", options->strongest, "List these alone (default: all)")
        .check(in_range(1, 1000000))
        .type_name("N");
    command.add_flag("--polarised", options->polarised,
                     "Also find the energies with polarisation carried along the path, not averaged at each surface");
    command
        .add_option("--image-circle", options->image_circle_mm,
                    "Diameter in which light counts, mm (default: as stated, else as the outermost chief ray has it)")
        .check(kPositiveOption)
        .type_name("MM");
    command
        .add_option("--plot", options->plot_file,
                    "Draw the strongest ghost's way through the lens, and the footprints of the eight strongest (SVG)")
        .type_name("FILE");
    add_ghost_image_options(command, options->image);
    add_mirror_options(command, options->mirrors);
    add_device_option(command, options->device);
    add_common_options(command, options->common);
    command.runs([options] { return run_ghosts(*options); });
}

}  // namespace lensproof::cli
