#include "experiments/cli/lens_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "engine/analysis/best_focus.h"
#include "engine/analysis/field_curves.h"
#include "engine/base/angle.h"
#include "engine/base/input_error.h"
#include "engine/base/text.h"
#include "engine/formats/prescription/load_lens.h"
#include "engine/formats/prescription/prescription_file.h"
#include "engine/formats/prescription/shipped_coatings.h"
#include "engine/optics/chief_ray.h"
#include "engine/optics/design_fields.h"
#include "engine/optics/focus.h"
#include "engine/spectral/wavelengths.h"
#include "experiments/cli/command.h"

namespace lensproof::cli {

namespace {

constexpr double kFarthestImage = 1e15;  // mm

constexpr const char* kCriteria[] = {"paraxial", "spot", "wavefront", "mtf"};

/// The object's distance: the option's, or that which the table is set to.
double object_distance(const std::string& option, const optics::Prescription& prescription) {
    if (option.empty()) {
        return prescription.object_distance_mm;
    }
    const std::optional<double> distance = option == "infinity" ? INFINITY : parse_number(option);
    if (!distance || !(*distance > 0.0)) {
        throw InputError(
            fmt::format("--focus is \"{}\", expected infinity, or a distance above 0 in mm", printable(option)));
    }
    return *distance;
}

/// The lens as it is analysed: zoomed, stopped down, focused, its sensor in place.
optics::Lens prepared_lens(const LensOptions& options, const optics::Prescription& prescription,
                           const optics::GlassCatalogue& glasses, double distance, double reference_wavelength_nm) {
    optics::Lens lens = formats::with_transmittance(
        optics::make_lens(formats::with_stop_picture(prescription), glasses, parse_indices(options.indices)));
    if (options.f_number) {
        lens = optics::with_f_number(std::move(lens), *options.f_number, reference_wavelength_nm);
    }
    if (!lens.focus_groups.empty() && !options.focus.empty()) {
        lens = optics::focused_at(std::move(lens), distance, reference_wavelength_nm);
    }
    if (options.image_distance_mm) {
        if (!(std::abs(*options.image_distance_mm) <= kFarthestImage)) {
            throw InputError(fmt::format("--image-distance is {}, expected mm from -{:g} to {:g}",
                                         *options.image_distance_mm, kFarthestImage, kFarthestImage));
        }
        lens.image_z = lens.last_vertex_z() + *options.image_distance_mm;
        return lens;
    }
    return analysis::with_image_plane(std::move(lens), distance, reference_wavelength_nm);
}

/// The fields to look at where none are given: the axis and four parts of what the source states, or of what the chief
/// ray reaches.
std::vector<double> usual_fields(const optics::Lens& lens, double wavelength_nm) {
    constexpr double kThousandths = 1000.0;  // a hair inside the last ray that passes, where rounding does not decide
    const double reached = degrees(optics::ChiefRays(lens, wavelength_nm).largest_field());
    const double largest = std::floor(kThousandths * reached) / kThousandths;
    const double stated = lens.stated.half_field_deg.value_or(largest);
    return analysis::even_fields(stated > 0.0 && stated < 180.0 ? stated : largest, 5);
}

std::vector<double> fields_of(const LensOptions& options, const optics::Prescription& prescription,
                              const optics::Lens& lens, const analysis::AnalysisSettings& settings) {
    for (const double field : options.fields_deg) {
        if (!(field > -180.0 && field < 180.0)) {
            throw InputError(fmt::format("--fields holds {}, expected degrees between -180 and 180", field));
        }
    }
    if (!options.fields_deg.empty()) {
        return options.fields_deg;
    }
    const std::vector<double> design =
        optics::design_fields_deg(prescription, lens, settings.reference_wavelength_nm, settings.object_distance);
    return design.empty() ? usual_fields(lens, settings.reference_wavelength_nm) : design;
}

std::vector<double> wavelengths_of(const LensOptions& options, const optics::Prescription& prescription) {
    if (options.wavelengths_nm.empty()) {
        return prescription.wavelengths_nm.empty() ? std::vector{spectral::kLineD, spectral::kLineF, spectral::kLineC}
                                                   : prescription.wavelengths_nm;
    }
    return options.wavelengths_nm;
}

/// Where the image is best, from where the image plane stands.
double best_focus_shift(const LensOptions& options, const optics::Lens& lens,
                        const analysis::AnalysisSettings& settings) {
    if (options.best_focus == "paraxial") {
        return analysis::paraxial_focus_shift(lens, settings.reference_wavelength_nm,
                                              analysis::distance_from_front(lens, settings.object_distance));
    }
    std::vector<analysis::WeightedField> fields;
    for (std::optional<analysis::PolychromaticField>& field : analysis::polychromatic_fields(lens, settings)) {
        if (field) {
            fields.push_back({.field = std::move(*field)});
        }
    }
    if (options.best_focus == "spot") {
        return analysis::spot_focus_shift(fields);
    }
    if (options.best_focus == "wavefront") {
        return analysis::wavefront_focus_shift(fields);
    }
    return analysis::mtf_focus_shift(fields, *options.focus_frequency);
}

}  // namespace

void add_lens_options(Command& command, LensOptions& options) {
    command.add_option("LENS", options.lens, "A prescription file, or the name of a lens that ships").required();
    command
        .add_option("--wavelengths", options.wavelengths_nm,
                    "nm; the first is the reference (default: those of a design program's file, else d, F, C)")
        .separated_by(',')
        .check(kPositiveOption)
        .type_name("NM,…");
    command
        .add_option("--reference-wavelength", options.reference_wavelength_nm,
                    "nm, of first-order data, Seidel sums and the image point of each field")
        .check(kPositiveOption)
        .type_name("NM");
    command
        .add_option(
            "--fields", options.fields_deg,
            "Field angles in degrees (default: those of a design program's file, else five, up to the field that "
            "the source states)")
        .separated_by(',')
        .check(kNumberOption)
        .type_name("DEG,…");
    command
        .add_option("--focus", options.focus,
                    "Distance of the object in front of the first vertex (default: the prescription's). Its focusing "
                    "groups move to it; a lens without any stays as it is, and --best-focus or --image-distance "
                    "moves the image plane")
        .type_name("infinity|MM");
    command
        .add_option("--f-number", options.f_number,
                    "Close the stop to this paraxial f-number, at the reference wavelength")
        .check(kPositiveOption)
        .type_name("N");
    command
        .add_option("--image-distance", options.image_distance_mm,
                    "Image plane behind the last vertex (default: the prescription's)")
        .check(kNumberOption)
        .type_name("MM");
    command.add_option("--rings", options.rings, "Rings of rays over a beam, for spots and wavefronts")
        .check(in_range(1, 1000))
        .shows_default();
    const Option best_focus =
        command
            .add_option("--best-focus", options.best_focus,
                        "Move the image plane to the best image of all fields and wavelengths together: paraxial, "
                        "spot (least rms, lateral colour included), wavefront (least rms) or mtf (highest at "
                        "--focus-frequency)")
            .check(one_of(std::vector<std::string>(std::begin(kCriteria), std::end(kCriteria))))
            .type_name("CRITERION");
    command.add_option("--focus-frequency", options.focus_frequency, "cycles/mm, for --best-focus mtf")
        .needs(best_focus)
        .check(kPositiveOption)
        .type_name("F");
    command.add_option("--zoom", options.zoom, "Position of a zoom lens, by name or number (default: the first)")
        .type_name("POSITION");
    add_index_option(command, options.indices);
    add_coating_option(command, options.coatings);
    add_glass_catalogue_option(command, options.glass_catalogues);
}

AnalysedLens read_analysed_lens(const LensOptions& options) {
    if (options.best_focus == "mtf" && !options.focus_frequency) {
        throw InputError("--best-focus mtf needs --focus-frequency, in cycles/mm");
    }
    optics::Prescription prescription =
        formats::with_coatings(formats::read_prescription(formats::find_lens_file(options.lens)), options.coatings);
    const std::size_t position = options.zoom.empty() ? 0 : optics::find_zoom_position(prescription, options.zoom);
    if (!prescription.zoom.empty()) {
        prescription.name += ", at " + prescription.zoom[position].name;
    }
    prescription = optics::at_zoom_position(std::move(prescription), position);
    analysis::AnalysisSettings settings;
    settings.wavelengths_nm = wavelengths_of(options, prescription);
    settings.reference_wavelength_nm = options.reference_wavelength_nm.value_or(settings.wavelengths_nm.front());
    settings.object_distance = object_distance(options.focus, prescription);
    settings.rings = options.rings;
    const optics::GlassCatalogue glasses =
        formats::with_own_catalogues(read_glass_catalogues(options.glass_catalogues), prescription);
    optics::Lens lens =
        prepared_lens(options, prescription, glasses, settings.object_distance, settings.reference_wavelength_nm);
    settings.fields_deg = fields_of(options, prescription, lens, settings);
    if (!options.best_focus.empty()) {
        const double shift = best_focus_shift(options, lens, settings);
        lens = analysis::with_image_shift(std::move(lens), shift);
    }
    return {std::move(prescription), std::move(lens), std::move(settings)};
}

AnalysedLens read_analysed_lens(const std::vector<std::string>& arguments) {
    std::ostringstream nowhere;
    Program program(
        "lensproof", "", [] { return ""; }, "", nowhere);
    Command command = program.add_command("analyze", "");
    LensOptions options;
    add_lens_options(command, options);
    std::optional<AnalysedLens> lens;
    command.runs([&] {
        lens = read_analysed_lens(options);
        return static_cast<int>(kDone);
    });
    std::vector<std::string> words = {"analyze"};
    words.insert(words.end(), arguments.begin(), arguments.end());
    program.run(words);
    if (!lens) {
        throw InputError("expected a lens and its options");
    }
    return *std::move(lens);
}

}  // namespace lensproof::cli
