#include "experiments/studies/photographed_lenses/measured_comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/base/infinity.h"
#include "engine/optics/focus.h"
#include "engine/spectral/wavelengths.h"

namespace lensproof::studies {

namespace {

constexpr double kTellingFactor = 2.0;  // in distance, of a lens without distortion
constexpr double kUsualWidth_px = 6000.0;
constexpr double kFullFrameWidth_mm = 36.0;

Json residual_json(const calibration::Residual& residual, const calibration::PhotographedLens& photographed) {
    const double half_diagonal_um = 1e3 * photographed.half_diagonal_mm();
    return {{"residual_rms_um", residual.rms_um},
            {"residual_largest_um", residual.largest_um},
            {"residual_rms_percent", 100.0 * residual.rms_um / half_diagonal_um},
            {"residual_rms_px", residual.rms_um / usual_pixel_um(photographed)}};
}

Json distortion_json(const MeasuredComparison& comparison) {
    Json json{{"residual_rms_um", nullptr}, {"residual_largest_um", nullptr}, {"scale", nullptr}};
    const auto& found = comparison.distortion;
    if (found) {
        json = residual_json(found->residual, comparison.photographed);
        json["scale"] = found->scale;
        json["largest_height"] = found->reach;
        json["measured_percent"] = found->photographed_percent;
        json["simulated_percent"] = found->simulated_percent;
    }
    json["half_diagonal_mm"] = comparison.photographed.half_diagonal_mm();
    json["pixel_pitch_um"] = usual_pixel_um(comparison.photographed);
    json["measured_departure_um"] = comparison.photographed_departure_um;
    json["simulated_departure_um"] = comparison.simulated_departure_um;
    json["limit_um"] = comparison.judgement.limit_um;
    json["verdict"] = findings::verdict_name(comparison.judgement.verdict);
    json["reason"] = comparison.judgement.reason;
    return json;
}

Json shift_json(const calibration::ShiftAgreement& shift, const calibration::PhotographedLens& photographed) {
    Json json = residual_json(shift.residual, photographed);
    json["measured_um"] = shift.photographed_um;
    json["simulated_um"] = shift.simulated_um;
    return json;
}

}  // namespace

double usual_pixel_um(const calibration::PhotographedLens& photographed) {
    return 1e3 * kFullFrameWidth_mm / photographed.crop_factor / kUsualWidth_px;
}

Judgement judge(const calibration::PhotographedLens& photographed,
                const std::optional<calibration::DistortionAgreement>& distortion) {
    using findings::Verdict;
    Judgement judgement{.limit_um = 1e3 * kLimitFraction * photographed.half_diagonal_mm(), .reason = {}};
    if (photographed.distortion_model.empty()) {
        judgement.reason = "the entry has no distortion";
        return judgement;
    }
    if (!distortion || distortion->reach < kLeastReachFraction) {
        judgement.reason = fmt::format("both image up to {:.0f} % of the half-diagonal only, expected {:.0f} % or more",
                                       distortion ? 100.0 * distortion->reach : 0.0, 100.0 * kLeastReachFraction);
        return judgement;
    }
    const double departure_um = 1e3 * calibration::departure_from_ideal(photographed);
    if (distortion->residual.rms_um > judgement.limit_um) {
        const bool is_fisheye = photographed.projection != optics::Projection::rectilinear;
        judgement.verdict = is_fisheye ? Verdict::inconclusive : Verdict::fail;
        judgement.reason = is_fisheye ? "lensfun's fisheyes are farther than the limit from lenses that are right"
                                      : "prescriptions of the photographed product are seldom so far from it";
    } else if (departure_um >= kTellingFactor * distortion->residual.rms_um) {
        judgement.verdict = Verdict::pass;
        judgement.reason = fmt::format("a lens without distortion would be {:.1f} µm from it", departure_um);
    } else {
        judgement.reason = fmt::format(
            "a lens without distortion would be {:.1f} µm from it, so many others agree as well", departure_um);
    }
    return judgement;
}

MeasuredComparison compare_distortion(const std::string& lens, const calibration::PhotographedLens& photographed,
                                      const calibration::ImagedField& field) {
    MeasuredComparison comparison{.photographed = photographed, .lens = lens};
    comparison.distortion = calibration::distortion_agreement(photographed, field);
    comparison.photographed_departure_um = 1e3 * calibration::departure_from_ideal(photographed);
    comparison.simulated_departure_um =
        1e3 * calibration::departure_from_ideal(field, photographed.projection, photographed.half_diagonal_mm());
    comparison.judgement = judge(photographed, comparison.distortion);
    return comparison;
}

optics::Lens focused_for_photographs(const optics::Lens& lens) {
    return optics::focused_at(lens, kInfinity);
}

MeasuredComparison compare_with_photographed(const optics::Lens& unfocused,
                                             const calibration::PhotographedLens& photographed,
                                             std::optional<double> wavelength_nm) {
    const optics::Lens lens = focused_for_photographs(unfocused);
    const double edge = photographed.half_diagonal_mm();
    const std::vector<calibration::SeenWavelength> light =
        wavelength_nm ? std::vector<calibration::SeenWavelength>{{.wavelength_nm = *wavelength_nm}}
                      : calibration::camera_wavelengths(lens);
    const calibration::ImagedField field = calibration::imaged_field(lens, light, edge);
    MeasuredComparison comparison = compare_distortion(lens.name, photographed, field);
    if (!wavelength_nm) {
        comparison.lateral_colour = calibration::lateral_colour_agreement(photographed, field);
    }
    for (const calibration::MeasuredVignetting& measured : photographed.vignetting) {
        comparison.vignetting.push_back({.f_number = measured.f_number,
                                         .measured = measured.brightness(1.0),
                                         .simulated = calibration::light_falloff(
                                             lens, measured.f_number, edge, wavelength_nm.value_or(spectral::kLineE))});
    }
    return comparison;
}

Json comparison_json(const MeasuredComparison& comparison) {
    const calibration::PhotographedLens& photographed = comparison.photographed;
    Json json{{"lens", comparison.lens},
              {"measured",
               {{"source", photographed.source},
                {"maker", photographed.maker},
                {"model", photographed.model},
                {"crop_factor", photographed.crop_factor},
                {"projection", optics::projection_name(photographed.projection)},
                {"focal_length_mm", photographed.focal_length_mm},
                {"distortion_model", photographed.distortion_model},
                {"remarks", photographed.remarks}}},
              {"distortion", distortion_json(comparison)},
              {"chromatic_shift", nullptr},
              {"vignetting", Json::list()}};
    if (const auto& colour = comparison.lateral_colour) {
        json["chromatic_shift"] = {{"red", shift_json(colour->red, photographed)},
                                   {"blue", shift_json(colour->blue, photographed)}};
    }
    for (const CornerLight& light : comparison.vignetting) {
        json["vignetting"].push_back(
            {{"f_number", light.f_number}, {"corner_measured", light.measured}, {"corner_simulated", light.simulated}});
    }
    return json;
}

}  // namespace lensproof::studies
