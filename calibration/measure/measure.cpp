#include "calibration/measure/measure.h"

#include <map>
#include <utility>

#include "calibration/chromatic/chromatic_shift.h"
#include "calibration/geometry/geometry_curves.h"
#include "calibration/geometry/model_choice.h"
#include "calibration/light/light_gradient.h"
#include "calibration/light/vignetting.h"
#include "calibration/measure/measure_bands.h"
#include "calibration/measure/measure_sharpness.h"
#include "calibration/measure/observe.h"
#include "engine/base/input_error.h"

namespace lensproof::calibration {
namespace {

struct Geometry {
    GeometryFit fit;
    std::optional<ModelChoice> choice;
};

Geometry fit(const MeasureInput& input, const Observations& seen) {
    GeometryOptions options = input.geometry;
    options.disc_diameter_mm = disc_diameter_mm(input.chart);
    if (input.model) {
        options.model = *input.model;
        return {fit_geometry(seen.chart_views, seen.width, seen.height, options), std::nullopt};
    }
    ChosenGeometry chosen = choose_model(seen.chart_views, seen.width, seen.height, options);
    return {std::move(chosen.fit), std::move(chosen.choice)};
}

void add_geometry(Profile& profile, const Observations& seen, const GeometryFit& geometry) {
    const double half_diagonal = half_diagonal_px(profile);
    profile.geometry =
        ProfileGeometry{.model = geometry.model,
                        .covariance = geometry.covariance,
                        .view_standard_error = geometry.view_standard_error,
                        .reprojection_rms_px = geometry.rms_px,
                        .views_used = static_cast<int>(geometry.views.size()),
                        .points_used = geometry.points_used,
                        .covered_image_height = geometry.covered_radius_px / half_diagonal,
                        .board = geometry.board,
                        .uncertainty = uncertainty_map(geometry, seen.chart_views, seen.width, seen.height),
                        .choice = std::nullopt};
    std::size_t next = 0;
    for (ProfileView& view : profile.views) {
        if (!view.found) {
            continue;
        }
        const ChartView& measured = seen.chart_views[next];
        const FittedView& fitted = geometry.views[next];
        const std::vector<std::optional<Vec2d>>& errors = seen.point_errors_px[next];
        view.lines = straightness(seen.lines[next], geometry.model);
        ++next;
        view.pose = fitted.pose;
        for (const PointResidual& r : fitted.residuals) {
            const auto i = static_cast<std::size_t>(r.index);
            view.points.push_back(
                {measured.chart_mm[i], measured.image_px[i], r.measured_minus_model_px, r.used, errors[i]});
        }
    }
    profile.curves[kQuantities.field_angle.key()] = field_angle_curve(geometry, half_diagonal);
    profile.curves[kQuantities.distortion.key()] = rectilinear_distortion_curve(geometry, half_diagonal);
    profile.curves[kQuantities.equidistant_distortion.key()] = equidistant_distortion_curve(geometry, half_diagonal);
}

void add_vignetting(Profile& profile, const Observations& seen, const Vec2d& centre) {
    const auto& groups = seen.flat_fields.empty() ? seen.whites : seen.flat_fields;
    for (const auto& [channel, samples] : groups) {
        try {
            Vignetting vignetting = fit_vignetting(samples, centre, half_diagonal_px(profile));
            profile.vignetting_models[channel] = fit_vignetting_models(vignetting);
            profile.shading[channel] = shading_grid(vignetting, seen.width, seen.height);
            FittedTerms& terms = profile.terms[kVignettingTerms(channel)];
            for (std::size_t i = 0; i < vignetting.coefficients.size(); ++i) {
                terms.names.push_back("spline_" + std::to_string(i));
            }
            terms.values = std::move(vignetting.coefficients);
            terms.covariance = std::move(vignetting.covariance);
            profile.curves[kQuantities.vignetting.key(channel)] = std::move(vignetting.ratio);
            profile.curves[kQuantities.vignetting_ev.key(channel)] = std::move(vignetting.ev);
        } catch (const InputError& e) {
            profile.not_measured[part::kVignetting] = e.what();
        }
    }
}

// What the charts' white shows of the lamps, now that the vignetting is known.
void add_light_gradients(Profile& profile, const Observations& seen, const Vec2d& centre) {
    for (std::size_t v = 0; v < profile.views.size(); ++v) {
        const auto white = seen.reference_whites.find(v);
        if (white == seen.reference_whites.end()) {
            continue;
        }
        const auto curve = profile.curves.find(kQuantities.vignetting.key(white->second.first));
        if (curve != profile.curves.end()) {
            const auto& [channel, index] = white->second;
            profile.views[v].traits->light_gradient_per_mm =
                light_gradient_per_mm(seen.whites.at(channel)[index], curve->second, centre, half_diagonal_px(profile));
        }
    }
}

void add_chromatic_shifts(Profile& profile, const Observations& seen, const Vec2d& centre) {
    if (seen.grey) {
        profile.not_measured[part::kChromaticShift] = "the pictures are grey";
        return;
    }
    if (seen.chromatic_pairs.empty()) {
        profile.not_measured[part::kChromaticShift] = "no chart was found in a picture in colour";
        return;
    }
    for (const auto& [channel, pairs] : seen.chromatic_pairs) {
        try {
            add_chromatic_shift(profile, channel_label(channel), pairs, centre);
        } catch (const InputError& e) {
            profile.not_measured[part::kChromaticShift] = e.what();
        }
    }
}

}  // namespace

Profile measure(const MeasureInput& input) {
    if (input.pictures.empty()) {
        throw InputError("measuring " + input.name + ": no pictures given: expected at least one");
    }
    const Observations seen = observe(input);
    const bool has_light_or_edges =
        !seen.flat_fields.empty() || !seen.sharpness.edges.empty() || !seen.sharpness.stars.empty();
    if (seen.chart_views.empty() && (!seen.views.empty() || !has_light_or_edges)) {
        throw none_usable(input, seen);
    }
    Profile profile;
    profile.name = input.name;
    profile.source = input.source;
    profile.source.images.clear();
    for (const Picture& picture : input.pictures) {
        profile.source.images.push_back(picture.name);
    }
    profile.width_px = seen.width;
    profile.height_px = seen.height;
    profile.channels = seen.channels;
    profile.pixel_pitch_um = input.pixel_pitch_um;
    profile.views = seen.views;
    profile.pictures = seen.pictures;

    Vec2d centre{(seen.width - 1) / 2.0, (seen.height - 1) / 2.0};
    if (seen.chart_views.empty()) {
        profile.not_measured[part::kGeometry] = shows_star(input)     ? "a Siemens star has but one point"
                                                : input.edges.empty() ? "there are flat fields only"
                                                                      : "there is no chart";
    } else {
        Geometry geometry = fit(input, seen);
        centre = centre_px(geometry.fit.model);
        add_geometry(profile, seen, geometry.fit);
        profile.geometry->choice = std::move(geometry.choice);
    }
    add_sharpness(profile, seen.sharpness, centre);
    add_vignetting(profile, seen, centre);
    add_light_gradients(profile, seen, centre);
    add_chromatic_shifts(profile, seen, centre);
    return profile;
}

}  // namespace lensproof::calibration
