#include "experiments/cli/compare_measured.h"

#include <fmt/format.h>

#include <string_view>

#include "calibration/photographed/dng_corrections.h"
#include "calibration/photographed/lensfun_database.h"
#include "engine/base/input_error.h"
#include "engine/formats/prescription/load_lens.h"
#include "engine/optics/paraxial.h"
#include "engine/spectral/wavelengths.h"
#include "experiments/cli/terminal.h"
#include "experiments/studies/photographed_lenses/measured_comparison.h"

namespace lensproof::cli {

namespace {

constexpr std::string_view kLensfun = "lensfun:";
constexpr std::string_view kDng = "dng:";

calibration::PhotographedLens read_photographed(const optics::Lens& lens, const MeasuredOptions& options) {
    if (options.measured.starts_with(kDng)) {
        if (!options.lensfun_data.empty()) {
            throw InputError(
                fmt::format("--lensfun-data {}: expected with --measured lensfun:MODEL only", options.lensfun_data));
        }
        return calibration::read_dng_corrections(options.measured.substr(kDng.size()), options.crop_factor);
    }
    if (!options.measured.starts_with(kLensfun) || options.measured.size() == kLensfun.size()) {
        throw InputError(fmt::format(
            "--measured is \"{}\", expected lensfun:MODEL, say lensfun:\"Canon FDn 24mm 1:2.8\", or dng:FILE",
            options.measured));
    }
    const calibration::LensfunDatabase database = options.lensfun_data.empty()
                                                      ? calibration::LensfunDatabase::of_system()
                                                      : calibration::LensfunDatabase::read(options.lensfun_data);
    return database.find(
        {.model = options.measured.substr(kLensfun.size()),
         .crop_factor = options.crop_factor,
         .focal_length_mm = optics::paraxial_data(optics::at_wavelength<double>(lens, spectral::kLineD)).efl});
}

void print_residual(const char* what, const calibration::Residual& residual,
                    const studies::MeasuredComparison& comparison) {
    const calibration::PhotographedLens& photographed = comparison.photographed;
    print("{:14} rms {:.3g} µm ({:.2g} % of the half-diagonal, {:.2g} px of 24 megapixels), largest {:.3g} µm\n", what,
          residual.rms_um, 0.1 * residual.rms_um / photographed.half_diagonal_mm(),
          residual.rms_um / studies::usual_pixel_um(photographed), residual.largest_um);
}

void print_comparison(const studies::MeasuredComparison& comparison) {
    const calibration::PhotographedLens& photographed = comparison.photographed;
    print("{} against {} ({}, {}, crop factor {:.4g}, {})\n", comparison.lens, photographed.model, photographed.source,
          photographed.maker, photographed.crop_factor, optics::projection_name(photographed.projection));
    for (const std::string& remark : photographed.remarks) {
        print("{:14} {}\n", "", remark);
    }
    if (const auto& distortion = comparison.distortion) {
        print_residual("distortion", distortion->residual, comparison);
        print("{:14} up to {:.0f} % of {:.2f} mm; focal length {:.4f} times the simulated one\n", "",
              100.0 * distortion->reach, photographed.half_diagonal_mm(), distortion->scale);
    }
    print("{:14} limit {:.3g} µm: {}, {}\n", "", comparison.judgement.limit_um,
          findings::verdict_name(comparison.judgement.verdict), comparison.judgement.reason);
    if (const auto& colour = comparison.lateral_colour) {
        print_residual("red − green", colour->red.residual, comparison);
        print_residual("blue − green", colour->blue.residual, comparison);
    }
    for (const studies::CornerLight& light : comparison.vignetting) {
        print("{:14} f/{:<4.3g} corner {:.3f} measured, {} simulated\n", "vignetting", light.f_number, light.measured,
              light.simulated ? fmt::format("{:.3f}", *light.simulated) : "not");
    }
}

}  // namespace

Option add_measured_options(Command& command, MeasuredOptions& options) {
    const Option measured =
        command.add_option("--measured", options.measured,
                           "In place of B: a lens calibrated from photographs, lensfun:MODEL, or as its "
                           "maker corrects it, dng:FILE");
    command
        .add_option("--crop-factor", options.crop_factor,
                    "Of its entry, where the model has several; of the DNG's sensor")
        .check(kPositiveOption)
        .needs(measured);
    command
        .add_option("--lensfun-data", options.lensfun_data,
                    "A copy of lensfun's database, file or folder, in place of the system's")
        .needs(measured);
    command.add_option("--wavelength", options.wavelength_nm, "One wavelength, nm, in place of a camera's response")
        .check(kPositiveOption)
        .needs(measured);
    return measured;
}

int compare_measured(const std::string& lens, const MeasuredOptions& options, const CommonOptions& common) {
    check_json_name(common);
    const optics::Lens loaded = formats::load_lens(lens);
    const calibration::PhotographedLens photographed = read_photographed(loaded, options);
    print_findings(common, loaded);
    const studies::MeasuredComparison comparison =
        studies::compare_with_photographed(loaded, photographed, options.wavelength_nm);
    if (prints_text(common)) {
        print_comparison(comparison);
    }
    Json json = studies::comparison_json(comparison);
    json["findings"] = findings_json(loaded.findings);
    write_json_result(common, json);
    return comparison.judgement.verdict == findings::Verdict::pass ? kDone : kCheckFailed;
}

}  // namespace lensproof::cli
