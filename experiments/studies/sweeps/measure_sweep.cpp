#include "experiments/studies/sweeps/measure_sweep.h"

#include <algorithm>
#include <array>
#include <iterator>

#include "engine/analysis/best_focus.h"
#include "engine/analysis/lens_analysis.h"
#include "engine/analysis/mtf.h"
#include "engine/base/input_error.h"
#include "engine/formats/prescription/load_lens.h"
#include "engine/optics/focus.h"
#include "engine/spectral/wavelengths.h"

namespace lensproof::studies {

namespace {

constexpr double kMicrometresPerMm = 1000.0;

std::optional<double> scaled(const std::optional<double>& value, double scale) {
    return value ? std::optional(scale * *value) : std::nullopt;
}

std::optional<double> difference(const std::optional<double>& a, const std::optional<double>& b) {
    return a && b ? std::optional(*a - *b) : std::nullopt;
}

/// By rays, as the keys of `analyze` have it.
std::map<std::string, std::optional<double>> ray_quantities(const analysis::LensAnalysis& analysis) {
    const analysis::FieldAnalysis& field = analysis.fields.front();
    const optics::ParaxialData& paraxial = analysis.paraxial.front();
    // d, F, C; or the one wavelength against the reference's.
    const std::optional<double> colour =
        analysis.fields.size() > 1 ? difference(analysis.fields[1].lateral_colour, analysis.fields[2].lateral_colour)
                                   : field.lateral_colour;
    return {{"spot_rms_um", scaled(field.spot_rms, kMicrometresPerMm)},
            {"distortion_percent", field.distortion_percent},
            {"relative_illumination", field.relative_illumination},
            {"vignetting", field.vignetting},
            {"transmittance", field.transmittance},
            {"lateral_colour_um", scaled(colour, kMicrometresPerMm)},
            {"tangential_focus_mm", field.tangential_focus},
            {"sagittal_focus_mm", field.sagittal_focus},
            {"astigmatism_mm", difference(field.tangential_focus, field.sagittal_focus)},
            {"wavefront_rms_waves", field.wavefront_rms_waves},
            {"chief_ray_height_mm",
             field.chief_ray_point ? std::optional(field.chief_ray_point->y) : std::optional<double>()},
            {"efl_mm", paraxial.efl},
            {"bfl_mm", paraxial.bfl},
            {"f_number_paraxial", paraxial.f_number},
            {"entrance_pupil_diameter_mm", paraxial.entrance_pupil_diameter}};
}

analysis::MtfCurve mtf_of(const analysis::PolychromaticField& field, const std::string& model, double frequency) {
    const std::array<double, 1> frequencies = {frequency};
    if (model == "geometric") {
        return analysis::geometric_mtf(field, frequencies);
    }
    return analysis::diffraction_mtf(
        field, frequencies,
        model == "diffraction-limited" ? analysis::MtfKind::diffraction_limited : analysis::MtfKind::diffraction);
}

void add_mtf(std::map<std::string, std::optional<double>>& found, const optics::Lens& lens,
             const analysis::AnalysisSettings& settings, const SweepSetting& setting) {
    found["mtf_tangential"] = std::nullopt;
    found["mtf_sagittal"] = std::nullopt;
    const auto fields = analysis::polychromatic_fields(lens, settings);
    if (!fields.front()) {
        return;
    }
    const analysis::MtfCurve curve = mtf_of(*fields.front(), setting.model, setting.frequency_per_mm.value());
    if (curve.status == analysis::PupilStatus::ok) {
        found["mtf_tangential"] = curve.tangential.front();
        found["mtf_sagittal"] = curve.sagittal.front();
    }
}

bool is_mtf(const std::string& quantity) {
    return sweep_quantity(quantity).is_mtf;
}

}  // namespace

const std::vector<SweepQuantity>& sweep_quantities() {
    static const std::vector<SweepQuantity> quantities = {
        {"mtf_tangential", "MTF", "tangential", "", true},
        {"mtf_sagittal", "MTF", "sagittal", "", true},
        {"spot_rms_um", "Spot, rms", "", "µm"},
        {"distortion_percent", "Distortion", "", "%"},
        {"relative_illumination", "Light over that on axis", "relative illumination", ""},
        {"vignetting", "Light over that on axis", "vignetting", ""},
        {"transmittance", "Transmittance of the chief ray", "", ""},
        {"lateral_colour_um", "Lateral colour", "", "µm"},
        {"tangential_focus_mm", "Focus from the image plane", "tangential", "mm"},
        {"sagittal_focus_mm", "Focus from the image plane", "sagittal", "mm"},
        {"astigmatism_mm", "Tangential less sagittal focus", "", "mm"},
        {"wavefront_rms_waves", "Wavefront, rms", "", "waves"},
        {"chief_ray_height_mm", "Height of the chief ray", "", "mm"},
        {"efl_mm", "Effective focal length", "", "mm"},
        {"bfl_mm", "Back focal length", "", "mm"},
        {"f_number_paraxial", "F-number", "", ""},
        {"entrance_pupil_diameter_mm", "Diameter of the entrance pupil", "", "mm"}};
    return quantities;
}

std::vector<std::string> sweep_quantity_keys() {
    std::vector<std::string> keys;
    std::ranges::transform(sweep_quantities(), std::back_inserter(keys), &SweepQuantity::key);
    return keys;
}

const SweepQuantity& sweep_quantity(const std::string& key) {
    return *std::ranges::find_if(sweep_quantities(), [&](const SweepQuantity& one) { return one.key == key; });
}

const std::vector<std::string>& mtf_models() {
    static const std::vector<std::string> models = {"diffraction", "diffraction-limited", "geometric"};
    return models;
}

SweepSetting sweep_setting(const std::vector<findings::Axis>& axes, std::size_t i) {
    const std::vector<std::size_t> place = findings::place_of(axes, i);
    SweepSetting setting;
    for (std::size_t a = 0; a < axes.size(); ++a) {
        const findings::Axis& axis = axes[a];
        if (axis.is_text()) {
            (axis.key == "lens"   ? setting.lens
             : axis.key == "zoom" ? setting.zoom
                                  : setting.model) = axis.texts[place[a]];
            continue;
        }
        const double number = axis.numbers[place[a]];
        if (axis.key == "field_deg") {
            setting.field_deg = number;
            continue;
        }
        (axis.key == "f_number"            ? setting.f_number
         : axis.key == "focus_distance_mm" ? setting.focus_distance_mm
         : axis.key == "image_shift_mm"    ? setting.image_shift_mm
         : axis.key == "frequency_per_mm"  ? setting.frequency_per_mm
                                           : setting.wavelength_nm) = number;
    }
    return setting;
}

void fields(JsonArchive& json, SweepValue& value) {
    json.field("quantities", value.quantities).field("refused", value.refused);
}

void SweptLens::set(const SweepSetting& setting) {
    if (setting_ && setting_->lens == setting.lens && setting_->zoom == setting.zoom &&
        setting_->f_number == setting.f_number && setting_->focus_distance_mm == setting.focus_distance_mm &&
        setting_->image_shift_mm == setting.image_shift_mm) {
        return;
    }
    setting_ = setting;
    lens_.reset();
    refused_.clear();
    optics::Lens lens = formats::load_lens(setting.lens, {.indices = {}, .zoom = setting.zoom, .glasses = {}});
    object_distance_mm_ = setting.focus_distance_mm.value_or(lens.object_distance_mm);
    try {
        if (setting.f_number) {
            lens = optics::with_f_number(std::move(lens), *setting.f_number);
        }
        lens = setting.focus_distance_mm
                   ? optics::focused_at(std::move(lens), object_distance_mm_)
                   : analysis::with_image_plane(std::move(lens), object_distance_mm_, spectral::kLineD);
        if (setting.image_shift_mm) {
            lens = analysis::with_image_shift(std::move(lens), *setting.image_shift_mm);
        }
        lens_ = std::move(lens);
    } catch (const InputError& error) {
        refused_ = error.what();
    }
}

SweepValue SweptLens::measure(const SweepSetting& setting, const std::vector<std::string>& quantities) {
    set(setting);
    SweepValue value;
    value.refused = refused_;
    std::map<std::string, std::optional<double>> found;
    if (lens_) {
        analysis::AnalysisSettings settings;
        settings.wavelengths_nm = setting.wavelength_nm
                                      ? std::vector{*setting.wavelength_nm}
                                      : std::vector{spectral::kLineD, spectral::kLineF, spectral::kLineC};
        settings.reference_wavelength_nm = spectral::kLineD;
        settings.fields_deg = {setting.field_deg};
        settings.object_distance = object_distance_mm_;
        if (!std::ranges::all_of(quantities, is_mtf)) {
            found = ray_quantities(analysis::analyze_lens(*lens_, settings));
        }
        if (std::ranges::any_of(quantities, is_mtf)) {
            add_mtf(found, *lens_, settings, setting);
        }
    }
    for (const std::string& quantity : quantities) {
        value.quantities[quantity] = found[quantity];
    }
    return value;
}

}  // namespace lensproof::studies
