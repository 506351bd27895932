// experiments/cli/analyze_command.cpp — `lensproof analyze LENS`: what a lens does, in the numbers that lens people
// use.
#include <fmt/format.h>

#include <cmath>
#include <memory>
#include <optional>

#include "engine/analysis/lens_analysis.h"
#include "engine/analysis/veiling_glare.h"
#include "engine/base/input_error.h"
#include "engine/base/write_file.h"
#include "experiments/cli/analysis_output.h"
#include "experiments/cli/command.h"
#include "experiments/cli/ghost_options.h"
#include "experiments/cli/lens_options.h"
#include "experiments/cli/terminal.h"
#include "experiments/draw/analysis_drawings.h"
#include "experiments/draw/curves_json.h"
#include "experiments/draw/lens_section.h"

namespace lensproof::cli {

namespace {

struct AnalyzeOptions {
    CommonOptions common;
    LensOptions lens;
    std::string plots_folder;
    bool has_veiling_glare = false;
    bool polarised = false;
    MirrorOptions mirrors;
};

/// "f/2.73, object at infinity, image plane 79.83 mm behind the last surface"
std::string conditions(const optics::Lens& lens, const analysis::AnalysisSettings& settings,
                       const analysis::LensAnalysis& analysis) {
    return fmt::format(
        "f/{:.3g}, object at {}, image plane {:.6g} mm behind the last surface", analysis.reference_paraxial.f_number,
        std::isinf(settings.object_distance) ? "infinity" : fmt::format("{:g} mm", settings.object_distance),
        lens.image_z - lens.last_vertex_z());
}

void write_analysis_plots(const AnalyzeOptions& options, const optics::Prescription& prescription,
                          const optics::Lens& lens, const analysis::AnalysisSettings& settings,
                          const analysis::LensAnalysis& analysis) {
    const analysis::RayCurves curves = analysis::ray_curves(lens, settings);
    const analysis::WaveCurves waves = analysis::wave_curves(lens, settings, options.common.threads);
    const draw::PlotHeading heading{.lens = lens.name, .conditions = conditions(lens, settings, analysis)};
    std::map<std::string, std::string> files = draw::analysis_drawings(heading, lens.projection, curves, waves);
    optics::Prescription shown = prescription;  // as it is analysed
    shown.object_distance_mm = settings.object_distance;
    shown.wavelengths_nm = {settings.reference_wavelength_nm};
    files["section.svg"] = draw::lens_section_svg(shown, &lens, {}, {.fields_deg = settings.fields_deg});
    files["curves.json"] = draw::curves_json(curves, waves).dump() + "\n";
    draw::write_plots(options.plots_folder, files);
    for (const analysis::PsfMap& psf : waves.psfs) {
        if (const std::optional<formats::Image> image = draw::psf_image(psf)) {
            formats::write_exr(*image, std::filesystem::path(options.plots_folder) / draw::psf_file_name(psf));
        }
    }
}

/// Of the black spot at the middle of the field, where the lens is focused.
std::optional<analysis::VeilingGlare> asked_veiling_glare(const AnalyzeOptions& options, const optics::Lens& lens,
                                                          const analysis::AnalysisSettings& settings) {
    if (!options.has_veiling_glare) {
        if (options.mirrors.sensor) {
            throw InputError("--sensor-reflectance stands without --veiling-glare, which it is for");
        }
        if (options.polarised) {
            throw InputError("--polarised stands without --veiling-glare, which it is for");
        }
        return std::nullopt;
    }
    return analysis::veiling_glare(lens,
                                   {.wavelength_nm = settings.reference_wavelength_nm,
                                    .spot_angle = analysis::tenth_of_field(lens, settings.reference_wavelength_nm),
                                    .object_distance = settings.object_distance,
                                    .mirrors = stray_mirrors(options.mirrors),
                                    .polarised = options.polarised,
                                    .seed = options.common.seed,
                                    .threads = options.common.threads});
}

int run_analyze(const AnalyzeOptions& options) {
    check_json_name(options.common);
    if (!options.plots_folder.empty()) {
        check_output_name(std::filesystem::path(options.plots_folder) / "curves.json");
    }
    const auto [prescription, lens, settings] = read_analysed_lens(options.lens);
    const analysis::LensAnalysis analysis = analysis::analyze_lens(lens, settings, options.common.threads);
    const std::optional<analysis::VeilingGlare> glare = asked_veiling_glare(options, lens, settings);
    if (!options.plots_folder.empty()) {
        write_analysis_plots(options, prescription, lens, settings, analysis);
    }
    if (prints_text(options.common)) {
        show(analysis_text(lens, settings, analysis) + (glare ? veiling_glare_text(*glare) : ""));
    }
    Json json = analysis_json(lens, settings, analysis);
    if (glare) {
        json["veiling_glare"] = veiling_glare_json(*glare);
    }
    write_json_result(options.common, json);
    return kDone;
}

}  // namespace

void add_analyze_command(Program& program) {
    const auto options = std::make_shared<AnalyzeOptions>();
    Command command =
        program.add_command("analyze", "First-order data, Seidel sums, real-ray curves, spots, wavefront");
    command.footer(
        "Example: lensproof analyze tessar --fields 0,12,24 --f-number 4 --plots tessar-plots\n"
        "Fields are angles at the entrance pupil; what does not exist (light from beyond the field, say) is null or "
        "a dash.");
    add_lens_options(command, options->lens);
    command
        .add_option("--plots", options->plots_folder,
                    "Draw the lens section, ray fans, field curves, spots, MTF and the rest into a folder (SVG), "
                    "their numbers beside them (curves.json)")
        .type_name("DIR");
    command.add_flag("--veiling-glare", options->has_veiling_glare,
                     "The veiling glare index too: what a black spot's image gets of its bright surround (ISO 9358)");
    command.add_flag("--polarised", options->polarised,
                     "That index too with the light's polarisation carried along its paths, and the difference");
    add_sensor_option(command, options->mirrors);
    add_common_options(command, options->common);
    command.runs([options] { return run_analyze(*options); });
}

}  // namespace lensproof::cli
