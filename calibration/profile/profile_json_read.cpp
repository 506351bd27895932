#include <algorithm>

#include "calibration/geometry/geometry_json.h"
#include "calibration/light/vignetting_json.h"
#include "calibration/profile/profile.h"
#include "engine/base/file.h"
#include "engine/base/input_error.h"
#include "engine/base/json_node.h"

namespace lensproof::calibration {
namespace {
using Node = JsonNode;

ProfileSource parse_source(const Node& node) {
    const std::string kind = node.at("kind").text();
    ProfileSource source{.kind = kind,
                         .images = node.at("images").texts(),
                         .camera = node.at("camera").text(),
                         .lens = node.at("lens").text()};
    if (node.has("settings")) {
        source.notes = parse_camera_notes(node.at("settings"));
    }
    if (node.has("suspicions")) {
        source.suspicions = node.at("suspicions").texts();
    }
    return source;
}

CameraModel parse_model(const Node& node) {
    const Node kind_node = node.at("kind");
    const std::optional<ModelKind> found = model_kind(kind_node.text());
    if (!found) {
        std::string known;
        for (const std::string& one : model_kind_names()) {
            known += (known.empty() ? "" : ", ") + one;
        }
        throw kind_node.error("one of " + known);
    }
    const CameraModel model = empty_model(*found);
    std::vector<double> values;
    for (const std::string& name : parameter_names(model)) {
        if (name == kStretchY && !node.at("parameters").has(name)) {
            values.push_back(0.0);
            continue;
        }
        const Node value = node.at("parameters").at(name).at("value");
        values.push_back(value.number());
        const bool length = name == "focal_length_px" || name == "normalisation_px" || name == "spline_end_rad";
        if (length && !(values.back() > 0.0)) {
            throw value.error("a positive value");
        }
    }
    return with_parameters(model, values);
}

ProfileGeometry parse_geometry(const Node& root) {
    ProfileGeometry geometry;
    const Node model = root.at("model");
    geometry.model = parse_model(model);
    std::vector<std::string> names = parameter_names(geometry.model);
    const std::size_t all = names.size();
    if (!model.at("parameters").has(std::string(kStretchY))) {
        names.pop_back();
    }
    const Node order = model.at("covariance").at("parameter_order");
    if (order.texts() != names) {
        throw order.error("the parameters in the model's order");
    }
    const Node matrix = model.at("covariance").at("matrix");
    const std::vector<Node> rows = matrix.elements();
    if (rows.size() != names.size()) {
        throw matrix.error("a matrix of " + std::to_string(names.size()) + " rows");
    }
    geometry.covariance.assign(all * all, 0.0);
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const std::vector<double> values = rows[i].numbers(names.size());
        std::copy(values.begin(), values.end(), geometry.covariance.begin() + static_cast<std::ptrdiff_t>(i * all));
        if (!(values[i] >= 0.0)) {
            throw matrix.error("variances that are not negative");
        }
    }
    for (const std::string& name : names) {
        const Node parameter = model.at("parameters").at(name);
        if (parameter.has("view_standard_error")) {
            geometry.view_standard_error.resize(all, 0.0);
            geometry.view_standard_error[static_cast<std::size_t>(&name - names.data())] =
                parameter.at("view_standard_error").number();
        }
    }
    geometry.reprojection_rms_px = root.at("reprojection_rms_px").number();
    geometry.views_used = root.at("views_used").count();
    geometry.points_used = root.at("points_used").count();
    geometry.covered_image_height = root.at("covered_image_height").number();
    if (root.has("board_shape")) {
        geometry.board = parse_board_shape(root.at("board_shape"));
    }
    if (root.has("model_choice")) {
        geometry.choice = parse_model_choice(root.at("model_choice"));
    }
    if (root.has("projection_uncertainty")) {
        geometry.uncertainty = parse_uncertainty_map(root.at("projection_uncertainty"));
    }
    return geometry;
}

FittedTerms parse_terms(const Node& node) {
    FittedTerms terms;
    const Node parameters = node.at("parameters");
    terms.names = parameters.keys();
    for (const std::string& name : terms.names) {
        terms.values.push_back(parameters.at(name).at("value").number());
    }
    for (const Node& row : node.at("covariance").elements()) {
        const std::vector<double> values = row.numbers(terms.names.size());
        terms.covariance.insert(terms.covariance.end(), values.begin(), values.end());
    }
    if (terms.covariance.size() != terms.names.size() * terms.names.size()) {
        throw node.at("covariance").error("a row and a column per parameter");
    }
    return terms;
}

ProfileView parse_view(const Node& node) {
    ProfileView view;
    view.image = node.at("image").text();
    view.found = node.at("found").truth();
    if (!view.found) {
        view.reason = node.has("reason") ? node.at("reason").text() : "";
        return view;
    }
    if (node.has("traits")) {
        view.traits = parse_traits(node.at("traits"));
    }
    view.pose = {node.at("rotation_vector_rad").triple(), node.at("translation_mm").triple()};
    for (const Node& point : node.at("points").elements()) {
        view.points.push_back({.chart_mm = point.at("chart_mm").pair(),
                               .image_px = point.at("image_px").pair(),
                               .residual_px = point.at("residual_px").pair(),
                               .used = point.at("used").truth()});
        if (point.has("standard_error_px")) {
            view.points.back().standard_error_px = point.at("standard_error_px").pair();
        }
    }
    if (node.has("numbering")) {
        view.numbering = node.at("numbering").text();
    }
    if (node.has("lines")) {
        for (const Node& line : node.at("lines").elements()) {
            view.lines.push_back(parse_line(line));
        }
    }
    return view;
}

Curve parse_curve(const Node& node) {
    Curve curve;
    curve.covered_image_height = node.at("covered_image_height").number();
    curve.image_height = node.at("image_height").numbers();
    const std::size_t count = curve.image_height.size();
    curve.value = node.at("value").numbers(count);
    curve.lower_95 = node.at("lower_95").numbers(count);
    curve.upper_95 = node.at("upper_95").numbers(count);
    if (!std::is_sorted(curve.image_height.begin(), curve.image_height.end())) {
        throw node.at("image_height").error("ascending heights");
    }
    return curve;
}

}  // namespace

Profile parse_profile(std::string_view text, const std::string& file) {
    const Node root = Node::parse(text, file);
    const Node schema = root.at("schema");
    if (schema.text() != kProfileSchema) {
        throw schema.error("\"" + std::string(kProfileSchema) + "\"");
    }
    Profile profile;
    profile.name = root.at("name").text();
    profile.source = parse_source(root.at("source"));
    const Node size = root.at("image_size_px");
    const std::vector<Node> sides = size.elements();
    if (sides.size() != 2) {
        throw size.error("[width, height]");
    }
    profile.width_px = sides[0].count();
    profile.height_px = sides[1].count();
    if (profile.width_px < 1 || profile.height_px < 1) {
        throw size.error("a width and a height of at least 1");
    }
    if (root.has("pixel_pitch_um")) {
        const Node pitch = root.at("pixel_pitch_um");
        profile.pixel_pitch_um = pitch.number();
        if (!(*profile.pixel_pitch_um > 0.0)) {
            throw pitch.error("a positive length");
        }
    }
    if (root.has("channels")) {
        profile.channels = root.at("channels").texts();
    }
    if (root.has("model")) {
        profile.geometry = parse_geometry(root);
    }
    if (root.has("pictures")) {
        for (const Node& picture : root.at("pictures").elements()) {
            profile.pictures.push_back(parse_picture_account(picture));
        }
    }
    for (const Node& view : root.at("views").elements()) {
        profile.views.push_back(parse_view(view));
    }
    const Node curves = root.at("curves");
    for (const std::string& name : curves.keys()) {
        profile.curves[name] = parse_curve(curves.at(name));
    }
    if (root.has("terms")) {
        const Node terms = root.at("terms");
        for (const std::string& name : terms.keys()) {
            profile.terms[name] = parse_terms(terms.at(name));
        }
    }
    if (root.has("sharpness")) {
        const Node channels = root.at("sharpness");
        for (const std::string& channel : channels.keys()) {
            for (const Node& edge : channels.at(channel).elements()) {
                profile.sharpness[channel].push_back(parse_edge(edge));
            }
        }
    }
    if (root.has("siemens_stars")) {
        const Node channels = root.at("siemens_stars");
        for (const std::string& channel : channels.keys()) {
            for (const Node& star : channels.at(channel).elements()) {
                profile.siemens_stars[channel].push_back(parse_star(star));
            }
        }
    }
    if (root.has("vignetting_models")) {
        const Node models = root.at("vignetting_models");
        for (const std::string& channel : models.keys()) {
            profile.vignetting_models[channel] = parse_vignetting_models(models.at(channel));
        }
    }
    if (root.has("shading")) {
        const Node grids = root.at("shading");
        for (const std::string& channel : grids.keys()) {
            profile.shading[channel] = parse_shading_grid(grids.at(channel));
        }
    }
    const Node reasons = root.at("not_measured");
    for (const std::string& name : reasons.keys()) {
        profile.not_measured[name] = reasons.at(name).text();
    }
    if (root.has("self_test")) {
        profile.self_test = parse_self_test(root.at("self_test"));
    }
    return profile;
}

Profile read_profile(const std::filesystem::path& file) {
    return parse_profile(read_file(file), file.string());
}

}  // namespace lensproof::calibration
