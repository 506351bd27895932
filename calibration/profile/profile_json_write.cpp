#include <algorithm>
#include <cmath>

#include "calibration/geometry/geometry_json.h"
#include "calibration/light/vignetting_json.h"
#include "calibration/profile/profile.h"
#include "engine/base/file.h"
#include "engine/base/json.h"

namespace lensproof::calibration {
namespace {
constexpr std::string_view kPixelConvention = "the centre of the top-left pixel is (0, 0), x to the right, y down";

Json pair(const Vec2d& v) {
    return Json::list({v.x, v.y});
}
Json triple(const Vec3d& v) {
    return Json::list({v.x, v.y, v.z});
}

Json source_json(const ProfileSource& source) {
    Json json = {{"kind", source.kind}, {"images", source.images}, {"camera", source.camera}, {"lens", source.lens}};
    if (source.notes) {
        json["settings"] = to_json(*source.notes);
    }
    if (!source.suspicions.empty()) {
        json["suspicions"] = source.suspicions;
    }
    return json;
}

Json model_json(const ProfileGeometry& geometry) {
    std::vector<std::string> names = parameter_names(geometry.model);
    const std::vector<double> values = parameters(geometry.model);
    const std::size_t all = names.size();
    if (stretch_y(geometry.model) == 0.0 && geometry.standard_error(all - 1) == 0.0) {
        names.pop_back();
    }
    Json list = Json::object();
    Json matrix = Json::list();
    for (std::size_t i = 0; i < names.size(); ++i) {
        list[names[i]] = {{"value", values[i]}, {"standard_error", geometry.standard_error(i)}};
        if (!geometry.view_standard_error.empty()) {
            list[names[i]]["view_standard_error"] = geometry.view_standard_error[i];
        }
        const auto row = geometry.covariance.begin() + static_cast<std::ptrdiff_t>(i * all);
        matrix.push_back(std::vector<double>(row, row + static_cast<std::ptrdiff_t>(names.size())));
    }
    return {{"kind", kind_name(geometry.model)},
            {"parameters", list},
            {"covariance", {{"parameter_order", names}, {"matrix", matrix}}}};
}

Json view_json(const ProfileView& view) {
    Json json = {{"image", view.image}, {"found", view.found}};
    if (!view.found) {
        if (!view.reason.empty()) {
            json["reason"] = view.reason;
        }
        return json;
    }
    if (view.traits) {
        json["traits"] = to_json(*view.traits);
    }
    if (!view.numbering.empty()) {
        json["numbering"] = view.numbering;
    }
    json["rotation_vector_rad"] = triple(view.pose.rotation_rad);
    json["translation_mm"] = triple(view.pose.translation_mm);
    Json points = Json::list();
    for (const ProfilePoint& p : view.points) {
        Json point = {{"chart_mm", pair(p.chart_mm)},
                      {"image_px", pair(p.image_px)},
                      {"residual_px", pair(p.residual_px)},
                      {"used", p.used}};
        if (p.standard_error_px) {
            point["standard_error_px"] = pair(*p.standard_error_px);
        }
        points.push_back(std::move(point));
    }
    json["points"] = std::move(points);
    for (const ProfileLine& line : view.lines) {
        json["lines"].push_back(to_json(line));
    }
    return json;
}

Json terms_json(const FittedTerms& terms) {
    const std::size_t count = terms.names.size();
    Json json{{"parameters", Json::object()}, {"covariance", Json::list()}};
    for (std::size_t i = 0; i < count; ++i) {
        const double variance = terms.covariance[i * (count + 1)];
        json["parameters"][terms.names[i]] = {{"value", terms.values[i]},
                                              {"standard_error", std::sqrt(std::max(variance, 0.0))}};
        const auto row = terms.covariance.begin() + static_cast<std::ptrdiff_t>(i * count);
        json["covariance"].push_back(std::vector<double>(row, row + static_cast<std::ptrdiff_t>(count)));
    }
    return json;
}

Json curve_json(const Curve& curve) {
    return {{"covered_image_height", curve.covered_image_height},
            {"image_height", curve.image_height},
            {"value", curve.value},
            {"lower_95", curve.lower_95},
            {"upper_95", curve.upper_95}};
}

}  // namespace

Json to_json(const Profile& profile) {
    Json json;
    json["schema"] = kProfileSchema;
    json["name"] = profile.name;
    json["source"] = source_json(profile.source);
    json["image_size_px"] = {profile.width_px, profile.height_px};
    json["channels"] = profile.channels;
    json["pixel_pitch_um"] = profile.pixel_pitch_um ? Json(*profile.pixel_pitch_um) : Json();
    json["pixel_convention"] = kPixelConvention;
    json["half_diagonal_px"] = half_diagonal_px(profile);
    if (profile.geometry) {
        json["model"] = model_json(*profile.geometry);
        const double focal = focal_length_px(profile.geometry->model);
        json["focal_length_px"] = focal;
        if (profile.pixel_pitch_um) {
            json["focal_length_mm"] = focal * *profile.pixel_pitch_um * 1e-3;
        }
        json["reprojection_rms_px"] = profile.geometry->reprojection_rms_px;
        json["views_used"] = profile.geometry->views_used;
        json["points_used"] = profile.geometry->points_used;
        json["covered_image_height"] = profile.geometry->covered_image_height;
        if (profile.geometry->board) {
            json["board_shape"] = to_json(*profile.geometry->board);
        }
        if (profile.geometry->choice) {
            json["model_choice"] = to_json(*profile.geometry->choice);
        }
        if (profile.geometry->uncertainty) {
            json["projection_uncertainty"] = to_json(*profile.geometry->uncertainty);
        }
    }
    json["pictures"] = Json::list();
    for (const PictureAccount& picture : profile.pictures) {
        json["pictures"].push_back(to_json(picture));
    }
    json["views"] = Json::list();
    for (const ProfileView& view : profile.views) {
        json["views"].push_back(view_json(view));
    }
    json["curves"] = Json::object();
    for (const auto& [name, curve] : profile.curves) {
        json["curves"][name] = curve_json(curve);
    }
    json["terms"] = Json::object();
    for (const auto& [name, terms] : profile.terms) {
        json["terms"][name] = terms_json(terms);
    }
    for (const auto& [channel, edges] : profile.sharpness) {
        Json list = Json::list();
        for (const ProfileEdge& edge : edges) {
            list.push_back(to_json(edge, profile.pixel_pitch_um));
        }
        json["sharpness"][channel] = std::move(list);
    }
    for (const auto& [channel, stars] : profile.siemens_stars) {
        Json list = Json::list();
        for (const ProfileStar& star : stars) {
            list.push_back(to_json(star, profile.pixel_pitch_um));
        }
        json["siemens_stars"][channel] = std::move(list);
    }
    for (const auto& [channel, models] : profile.vignetting_models) {
        json["vignetting_models"][channel] = to_json(models);
    }
    for (const auto& [channel, grid] : profile.shading) {
        json["shading"][channel] = to_json(grid);
    }
    json["not_measured"] = Json::object();
    for (const auto& [name, reason] : profile.not_measured) {
        json["not_measured"][name] = reason;
    }
    if (profile.self_test) {
        json["self_test"] = to_json(*profile.self_test);
    }
    return json;
}

void write_profile(const Profile& profile, const std::filesystem::path& file) {
    write_file(file, to_json(profile).dump(1) + "\n");
}

}  // namespace lensproof::calibration
