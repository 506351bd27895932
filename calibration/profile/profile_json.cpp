#include <fmt/format.h>

#include <algorithm>

#include "calibration/geometry/geometry_json.h"
#include "calibration/light/vignetting_json.h"
#include "calibration/profile/profile.h"
#include "calibration/statistics/estimates_json.h"
#include "engine/base/file.h"
#include "engine/base/write_file.h"

namespace lensproof::calibration {

// Outside the unnamed namespace, because the archive looks for them where the types are.

static void fields(JsonArchive& json, ProfileSource& source) {
    json.field("kind", source.kind)
        .field("images", source.images)
        .field("camera", source.camera)
        .field("lens", source.lens);
    if (json.present("settings", source.notes)) {
        json.group("settings", [&](JsonArchive& settings) { fields(settings, *source.notes); });
    }
    json.optional("suspicions", source.suspicions);
}

static void fields(JsonArchive& json, ProfilePoint& point) {
    json.optional("direction", point.direction);
    if (!point.direction) {
        json.field("chart_mm", point.chart_mm);
    }
    json.field("image_px", point.image_px)
        .field("residual_px", point.residual_px)
        .field("used", point.used)
        .optional("standard_error_px", point.standard_error_px);
}

static void fields(JsonArchive& json, ProfileView& view) {
    json.field("image", view.image).field("found", view.found);
    if (!view.found) {
        json.optional("reason", view.reason);
        return;
    }
    json.optional("traits", view.traits).optional("numbering", view.numbering);
    if (json.present("rotation_vector_rad", view.pose)) {
        json.field("rotation_vector_rad", view.pose->rotation_rad).field("translation_mm", view.pose->translation_mm);
    }
    json.field("points", view.points).optional("lines", view.lines);
}

static void fields(JsonArchive& json, FittedTerms& terms) {
    estimates(json, terms.names, terms.values, terms.covariance);
    json.rows("covariance", terms.covariance, terms.names.size(), terms.names.size(),
              "a row and a column per parameter");
}

static void fields(JsonArchive& json, Curve& curve) {
    json.field("covered_image_height", curve.covered_image_height)
        .field("image_height", curve.image_height)
        .numbers("value", curve.value, curve.image_height.size())
        .numbers("lower_95", curve.lower_95, curve.image_height.size())
        .numbers("upper_95", curve.upper_95, curve.image_height.size())
        .expect("image_height", std::ranges::is_sorted(curve.image_height), "ascending heights");
}

namespace {
constexpr const char* kPixelConvention = "the centre of the top-left pixel is (0, 0), x to the right, y down";

// What is fitted and held: a stretch_y only where there is one.
std::vector<std::string> written_names(const JsonArchive& parameters, const ProfileGeometry& geometry) {
    std::vector<std::string> names = parameter_names(geometry.model);
    if (parameters.reading() ? parameters.lacks(kStretchY)
                             : stretch_y(geometry.model) == 0.0 && geometry.standard_error(names.size() - 1) == 0.0) {
        names.pop_back();
    }
    return names;
}

void parameter_fields(JsonArchive& json, const std::string& name, std::size_t i, double& value,
                      ProfileGeometry& geometry) {
    const bool is_length = name == "focal_length_px" || name == "normalisation_px" || name == "spline_end_rad";
    std::vector<double>& view_errors = geometry.view_standard_error;
    std::optional<double> view_error = view_errors.empty() ? std::nullopt : std::optional(view_errors[i]);
    json.field("value", value)
        .expect("value", !is_length || value > 0.0, "a positive value")
        .derived("standard_error", geometry.standard_error(i))
        .optional("view_standard_error", view_error);
    if (view_error) {
        view_errors.resize(parameters(geometry.model).size(), 0.0);
        view_errors[i] = *view_error;
    }
}

void model_fields(JsonArchive& json, ProfileGeometry& geometry) {
    ModelKind model = kind(geometry.model);
    json.one_of("kind", model, model_kind_names(), fmt::format("one of {}", fmt::join(model_kind_names(), ", ")));
    if (json.reading()) {
        geometry.model = empty_model(model);
    }
    std::vector<double> values = parameters(geometry.model);
    const std::size_t all = values.size();
    geometry.covariance.resize(all * all);
    std::vector<std::string> names;
    json.group("parameters", [&](JsonArchive& list) {
        names = written_names(list, geometry);
        for (std::size_t i = 0; i < names.size(); ++i) {
            list.group(names[i], [&](JsonArchive& one) { parameter_fields(one, names[i], i, values[i], geometry); });
        }
    });
    geometry.model = with_parameters(geometry.model, values);
    json.group("covariance", [&](JsonArchive& covariance) {
        covariance.constant("parameter_order", names, "the parameters in the model's order")
            .rows("matrix", geometry.covariance, names.size(), all, fmt::format("a matrix of {} rows", names.size()));
        for (std::size_t i = 0; i < names.size(); ++i) {
            covariance.expect("matrix", geometry.covariance[i * (all + 1)] >= 0.0, "variances that are not negative");
        }
    });
}

void geometry_fields(JsonArchive& json, ProfileGeometry& geometry, const std::optional<double>& pixel_pitch_um) {
    json.group("model", [&](JsonArchive& model) { model_fields(model, geometry); });
    const double focal_px = focal_length_px(geometry.model);
    json.derived("focal_length_px", focal_px);
    if (pixel_pitch_um) {
        json.derived("focal_length_mm", focal_px * *pixel_pitch_um * 1e-3);
    }
    json.field("reprojection_rms_px", geometry.reprojection_rms_px)
        .field("views_used", geometry.views_used)
        .field("points_used", geometry.points_used)
        .field("covered_image_height", geometry.covered_image_height)
        .optional("board_shape", geometry.board)
        .optional("model_choice", geometry.choice)
        .optional("projection_uncertainty", geometry.uncertainty);
}

void size_fields(JsonArchive& json, Profile& profile) {
    std::vector<int> sides = {profile.width_px, profile.height_px};
    json.field("image_size_px", sides).expect("image_size_px", sides.size() == 2, "[width, height]");
    json.expect("image_size_px", sides[0] >= 1 && sides[1] >= 1, "a width and a height of at least 1");
    profile.width_px = sides[0];
    profile.height_px = sides[1];
}

}  // namespace

void fields(JsonArchive& json, Profile& profile) {
    const std::optional<double>& pitch = profile.pixel_pitch_um;
    json.constant("schema", std::string(kProfileSchema), fmt::format("\"{}\"", kProfileSchema))
        .field("name", profile.name)
        .field("source", profile.source)
        .optional("warnings", profile.warnings);
    size_fields(json, profile);
    json.added("channels", profile.channels)
        .added("pixel_pitch_um", profile.pixel_pitch_um)
        .expect("pixel_pitch_um", pitch.value_or(1.0) > 0.0, "a positive length")
        .derived("pixel_convention", kPixelConvention)
        .derived("half_diagonal_px", half_diagonal_px(profile));
    if (json.present("model", profile.geometry)) {
        geometry_fields(json, *profile.geometry, pitch);
    }
    json.added("pictures", profile.pictures)
        .field("views", profile.views)
        .field("curves", profile.curves)
        .added("terms", profile.terms)
        .optional("sharpness", profile.sharpness, pitch)
        .optional("siemens_stars", profile.siemens_stars, pitch)
        .optional("scene_lines", profile.scene_lines)
        .optional("vignetting_models", profile.vignetting_models)
        .optional("shading", profile.shading)
        .field("not_measured", profile.not_measured)
        .optional("self_test", profile.self_test);
}

Profile parse_profile(std::string_view text, const std::string& file) {
    return from_json<Profile>(JsonNode::parse(text, file));
}

Profile read_profile(const std::filesystem::path& file) {
    return parse_profile(read_file(file), file.string());
}

void write_profile(const Profile& profile, const std::filesystem::path& file) {
    write_file(file, to_json(profile).dump(1) + "\n");
}

}  // namespace lensproof::calibration
