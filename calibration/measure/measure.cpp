#include "calibration/measure/measure.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "calibration/chromatic/chromatic_shift.h"
#include "calibration/geometry/geometry_curves.h"
#include "calibration/geometry/handedness.h"
#include "calibration/geometry/model_choice.h"
#include "calibration/geometry/plane_distortion.h"
#include "calibration/light/light_gradient.h"
#include "calibration/light/vignetting.h"
#include "calibration/measure/measure_bands.h"
#include "calibration/measure/measure_lines.h"
#include "calibration/measure/measure_sharpness.h"
#include "calibration/measure/observe.h"
#include "engine/base/input_error.h"

namespace lensproof::calibration {
namespace {

// A place known to no better than this of half the diagonal: as where a fit refuses a principal point.
constexpr double kUnknownPlace = 0.05;

struct Geometry {
    GeometryFit fit;
    std::optional<ModelChoice> choice;
    std::vector<GeometryFit> rivals;  // to the choice
};

std::vector<ChartView> charts_in(const Observations& seen) {
    std::vector<ChartView> charts;
    for (const PictureObservation& picture : seen.pictures) {
        if (picture.shows_chart()) {
            charts.push_back(picture.points);
        }
    }
    return charts;
}

Vec2d middle_px(const Observations& seen) {
    return {(seen.width - 1) / 2.0, (seen.height - 1) / 2.0};
}

/// A point of the fit as the profile has it.
ProfilePoint profile_point(const PictureObservation& picture, const PointResidual& residual) {
    const auto i = static_cast<std::size_t>(residual.index);
    ProfilePoint point{.image_px = picture.points.image_px[i],
                       .residual_px = residual.measured_minus_model_px,
                       .used = residual.used,
                       .standard_error_px = picture.point_errors_px[i]};
    if (picture.points.is_far()) {
        point.direction = picture.points.directions[i];
    } else {
        point.chart_mm = picture.points.chart_mm[i];
    }
    return point;
}

Geometry fit(const MeasureInput& input, const Observations& seen, const std::vector<ChartView>& charts) {
    GeometryOptions options = input.geometry;
    options.disc_diameter_mm = disc_diameter_mm(input.chart);
    if (input.model) {
        options.model = *input.model;
        return {fit_geometry(charts, seen.width, seen.height, options), std::nullopt, {}};
    }
    ChosenGeometry chosen = choose_model(charts, seen.width, seen.height, options);
    return {std::move(chosen.fit), std::move(chosen.choice), std::move(chosen.rivals)};
}

void add_geometry(Profile& profile, Observations& seen, const std::vector<ChartView>& charts,
                  const GeometryFit& geometry, const std::vector<GeometryFit>& rivals) {
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
                        .uncertainty = uncertainty_map(geometry, charts, seen.width, seen.height, rivals),
                        .choice = std::nullopt};
    auto fitted = geometry.views.begin();
    for (PictureObservation& picture : seen.pictures) {
        if (!picture.shows_chart()) {
            continue;
        }
        picture.view->lines = straightness(picture.lines, geometry.model);
        picture.view->pose = fitted->pose;
        for (const PointResidual& r : fitted->residuals) {
            picture.view->points.push_back(profile_point(picture, r));
        }
        ++fitted;
    }
    profile.curves[kQuantities.field_angle.key()] = field_angle_curve(geometry, half_diagonal);
    profile.curves[kQuantities.distortion.key()] = rectilinear_distortion_curve(geometry, half_diagonal);
    profile.curves[kQuantities.equidistant_distortion.key()] = equidistant_distortion_curve(geometry, half_diagonal);
}

// What flat charts tell though they do not tell the camera.
void add_plane_distortion(Profile& profile, Observations& seen, const std::vector<ChartView>& charts) {
    const PlaneDistortion distortion = fit_plane_distortion(charts, seen.width, seen.height);
    auto residuals = distortion.residuals.begin();
    for (PictureObservation& picture : seen.pictures) {
        if (!picture.shows_chart()) {
            continue;
        }
        for (const PointResidual& r : *residuals) {
            picture.view->points.push_back(profile_point(picture, r));
        }
        ++residuals;
    }
    FittedTerms& terms = profile.terms[kPlaneDistortionTerms()];
    for (std::size_t i = 1; i <= distortion.coefficients.size(); ++i) {
        terms.names.push_back("k" + std::to_string(i));
    }
    terms.values = distortion.coefficients;
    terms.covariance = distortion.covariance;
    profile.curves[kQuantities.distortion.key()] = distortion_curve(distortion, half_diagonal_px(profile));
}

// What nobody may overlook of a fit that was made.
void add_warnings(Profile& profile, const std::vector<ChartView>& charts, const GeometryFit& geometry) {
    const std::vector<std::optional<double>>& places = profile.geometry->uncertainty->far_px;
    double worst = 0.0;
    for (const std::optional<double>& uncertainty : places) {
        worst = std::max(worst, uncertainty.value_or(0.0));
    }
    const bool is_far = std::ranges::all_of(charts, &ChartView::is_far);
    if (worst > kUnknownPlace * half_diagonal_px(profile)) {
        profile.warnings.push_back(fmt::format(
            "the pictures do not say what the camera does in all of the frame: a place is known to ± {:.3g} px "
            "at worst; add {}",
            worst,
            is_far ? "directions that are seen in the corners"
                   : "views of the chart that reach into the corners, tilted by 20° or more"));
    }
    if (const auto dark = std::ranges::count(places, false, &std::optional<double>::has_value); dark > 0) {
        profile.warnings.push_back(fmt::format(
            "the model images nothing in {:.1f} % of the frame, farthest from its centre: those places are dark, as a "
            "circular fisheye's corners, or the pictures do not say what the camera does there",
            100.0 * static_cast<double>(dark) / static_cast<double>(places.size())));
    }
    if (charts.size() == 1 && !is_far) {
        profile.warnings.emplace_back(
            "one picture tells noise from nothing else: errors that it has as a whole (a chart that is not flat, "
            "corners that lie aside) are in no stated error; add views");
    }
    for (std::size_t v = 0; v < charts.size(); ++v) {
        if (geometry.views[v].weight < 1.0) {
            profile.warnings.push_back(
                fmt::format("{} disagrees with the other pictures as a whole: its points scatter {:.1f} times as much, "
                            "and each counts {:.2g} of another's (a chart that moved or bent, or a wrong shape?)",
                            charts[v].name, 1.0 / std::sqrt(geometry.views[v].weight), geometry.views[v].weight));
        }
    }
}

// Measures the camera; of charts that do not tell it, what needs none. Returns the optical centre.
Vec2d measure_geometry(Profile& profile, Observations& seen, const MeasureInput& input,
                       const std::vector<ChartView>& charts) {
    const bool is_far = has_role(input, PictureRole::directions);
    if (is_far) {
        check_handedness(charts, seen.width, seen.height);
    }
    try {
        Geometry geometry = fit(input, seen, charts);
        add_geometry(profile, seen, charts, geometry.fit, geometry.rivals);
        add_warnings(profile, charts, geometry.fit);
        profile.geometry->choice = std::move(geometry.choice);
        return centre_px(profile.geometry->model);
    } catch (const InputError& e) {
        if (input.model || is_far) {
            throw;
        }
        profile.not_measured[part::kGeometry] = e.what();
    }
    try {
        add_plane_distortion(profile, seen, charts);
    } catch (const InputError& e) {
        profile.not_measured[part::kDistortion] = e.what();
    }
    return middle_px(seen);
}

// By channel, of the flat fields where there are any, else of the charts' white.
std::map<std::string, std::vector<LightGroup>> light_in(const Observations& seen) {
    std::map<std::string, std::vector<LightGroup>> flat_fields;
    std::map<std::string, std::vector<LightGroup>> whites;
    for (const PictureObservation& picture : seen.pictures) {
        for (const auto& [channel, group] : picture.light) {
            (picture.view ? whites : flat_fields)[channel].push_back(group);
        }
    }
    return flat_fields.empty() ? whites : flat_fields;
}

void add_vignetting(Profile& profile, const Observations& seen, const Vec2d& centre) {
    const std::map<std::string, std::vector<LightGroup>> light = light_in(seen);
    if (light.empty()) {
        profile.not_measured[part::kVignetting] = "no chart's white and no even surface was seen";
    }
    for (const auto& [channel, samples] : light) {
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
void add_light_gradients(const Profile& profile, Observations& seen, const Vec2d& centre) {
    for (PictureObservation& picture : seen.pictures) {
        const auto white = picture.light.find(picture.reference_channel);
        const Curve* vignetting = find_curve(profile, kQuantities.vignetting.key(picture.reference_channel));
        if (picture.shows_chart() && white != picture.light.end() && vignetting != nullptr) {
            picture.view->traits->light_gradient_per_mm =
                light_gradient_per_mm(white->second, *vignetting, centre, half_diagonal_px(profile));
        }
    }
}

void add_chromatic_shifts(Profile& profile, const Observations& seen, const Vec2d& centre) {
    if (seen.grey) {
        profile.not_measured[part::kChromaticShift] = "the pictures are grey";
        return;
    }
    std::map<std::string, std::vector<ChromaticPair>> pairs_in;  // by channel
    for (const PictureObservation& picture : seen.pictures) {
        for (const auto& [channel, pairs] : picture.chromatic_pairs) {
            pairs_in[channel].insert(pairs_in[channel].end(), pairs.begin(), pairs.end());
        }
    }
    if (pairs_in.empty()) {
        profile.not_measured[part::kChromaticShift] =
            seen.sharpness.coloured_edges > 0
                ? "all edges that were found are between two colours, whose shift need not be the lens's"
                : "no chart and no edges were found in a picture in colour";
        return;
    }
    for (const auto& [channel, pairs] : pairs_in) {
        try {
            add_chromatic_shift(profile, channel_label(channel), pairs, centre);
        } catch (const InputError& e) {
            profile.not_measured[part::kChromaticShift] =
                e.what() +
                (seen.sharpness.coloured_edges > 0
                     ? fmt::format(" ({} edges between two colours are left out)", seen.sharpness.coloured_edges)
                     : "");
        }
    }
}

}  // namespace

std::vector<std::string> known_parts() {
    return {"distortion", "vignetting", "chromatic-shift", "sharpness"};
}

WantedParts parts_named(const std::vector<std::string>& names) {
    const auto has = [&](const char* name) { return std::ranges::count(names, name) > 0; };
    return {.vignetting = has("vignetting"), .chromatic_shift = has("chromatic-shift"), .sharpness = has("sharpness")};
}

Profile measure(const MeasureInput& input) {
    if (input.pictures.empty()) {
        throw InputError("measuring " + input.name + ": no pictures given: expected at least one");
    }
    if (shows_star(input) && !input.parts.sharpness) {
        throw InputError("a Siemens star tells sharpness, which was not asked for, and nothing else");
    }
    Observations seen = observe(input);
    const std::vector<ChartView> charts = charts_in(seen);
    const bool is_lit = std::ranges::any_of(seen.pictures, [](const auto& picture) { return !picture.light.empty(); });
    const bool is_sharp = !seen.sharpness.edges.empty() || !seen.sharpness.stars.empty();
    const bool has_lines =
        std::ranges::any_of(seen.pictures, [](const auto& picture) { return !picture.scene_lines.empty(); });
    if (charts.empty() && (looks_for_charts(seen) || (has_role(input, PictureRole::lines) && !has_lines) ||
                           !(is_lit || is_sharp || has_lines))) {
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

    Vec2d centre = middle_px(seen);
    if (has_lines) {
        centre = measure_lines(profile, seen);
    } else if (charts.empty()) {
        profile.not_measured[part::kGeometry] = shows_star(input) ? "a Siemens star has but one point"
                                                : has_role(input, PictureRole::edges) ? "there is no chart"
                                                                                      : "there are flat fields only";
    } else {
        centre = measure_geometry(profile, seen, input, charts);
    }
    const WantedParts& parts = input.parts;
    const auto measure_part = [&](const char* name, bool is_wanted, const auto& add) {
        if (is_wanted) {
            add();
        } else {
            profile.not_measured[name] = "was not asked for";
        }
    };
    if (!has_lines || is_lit) {
        measure_part(part::kVignetting, parts.vignetting, [&] { add_vignetting(profile, seen, centre); });
    }
    if (!has_lines) {
        measure_part(part::kSharpness, parts.sharpness, [&] { add_sharpness(profile, seen.sharpness, centre); });
        add_light_gradients(profile, seen, centre);
        measure_part(part::kChromaticShift, parts.chromatic_shift,
                     [&] { add_chromatic_shifts(profile, seen, centre); });
    }
    if (!charts.empty() && !profile.geometry && profile.curves.empty()) {
        throw InputError(profile.not_measured[part::kGeometry]);
    }
    for (PictureObservation& picture : seen.pictures) {
        profile.pictures.push_back(std::move(picture.account));
        if (picture.view) {
            profile.views.push_back(std::move(*picture.view));
        }
    }
    return profile;
}

}  // namespace lensproof::calibration
