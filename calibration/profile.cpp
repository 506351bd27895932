#include "calibration/profile.h"

#include <algorithm>
#include <cmath>

#include "engine/io/file.h"
#include "engine/io/input_error.h"

namespace lensproof {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view kSchema = "lensproof-profile/1";
constexpr std::string_view kPixelConvention = "the centre of the top-left pixel is (0, 0), x to the right, y down";

Json pair(const Vec2d& v) {
    return Json::array({v.x, v.y});
}
Json triple(const Vec3d& v) {
    return Json::array({v.x, v.y, v.z});
}

Json source_json(const ProfileSource& source) {
    return {{"kind", source.kind}, {"images", source.images}, {"camera", source.camera}, {"lens", source.lens}};
}

Json model_json(const ProfileGeometry& geometry) {
    const std::vector<std::string> names = parameter_names(geometry.model);
    const std::vector<double> values = parameters(geometry.model);
    Json list = Json::object();
    Json matrix = Json::array();
    for (std::size_t i = 0; i < names.size(); ++i) {
        list[names[i]] = {{"value", values[i]}, {"standard_error", geometry.standard_error(i)}};
        const auto row = geometry.covariance.begin() + static_cast<std::ptrdiff_t>(i * names.size());
        matrix.push_back(std::vector<double>(row, row + static_cast<std::ptrdiff_t>(names.size())));
    }
    return {{"kind", kind_name(geometry.model)},
            {"parameters", list},
            {"covariance", {{"parameter_order", names}, {"matrix", matrix}}}};
}

Json view_json(const ProfileView& view) {
    Json json = {{"image", view.image}, {"found", view.found}};
    if (!view.found) {
        return json;
    }
    json["rotation_vector_rad"] = triple(view.pose.rotation_rad);
    json["translation_mm"] = triple(view.pose.translation_mm);
    Json points = Json::array();
    for (const ProfilePoint& p : view.points) {
        points.push_back({{"chart_mm", pair(p.chart_mm)},
                          {"image_px", pair(p.image_px)},
                          {"residual_px", pair(p.residual_px)},
                          {"used", p.used}});
    }
    json["points"] = std::move(points);
    return json;
}

Json terms_json(const FittedTerms& terms) {
    const std::size_t count = terms.names.size();
    Json json{{"parameters", Json::object()}, {"covariance", Json::array()}};
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

// A value in the file, and the way to it for messages.
class Node {
  public:
    Node(const Json& value, std::string file, std::string key)
        : value_(&value), file_(std::move(file)), key_(std::move(key)) {}

    [[nodiscard]] InputError error(const std::string& expected) const {
        std::string found = value_->dump(-1, ' ', false, Json::error_handler_t::replace);
        if (found.size() > 60) {
            found = std::string(value_->type_name()) + " of " + std::to_string(value_->size()) + " values";
        }
        return InputError(file_ + ": " + (key_.empty() ? "the file" : key_) + " is " + found + ": expected " +
                          expected);
    }
    [[nodiscard]] bool has(const std::string& key) const { return value_->is_object() && value_->contains(key); }
    [[nodiscard]] bool is_null() const { return value_->is_null(); }
    [[nodiscard]] Node at(const std::string& key) const {
        if (!value_->is_object()) {
            throw error("an object");
        }
        const std::string path = key_.empty() ? key : key_ + "." + key;
        const auto found = value_->find(key);
        if (found == value_->end()) {
            throw InputError(file_ + ": " + path + " is missing: expected in a " + std::string(kSchema) + " file");
        }
        return {*found, file_, path};
    }
    [[nodiscard]] double number() const {
        if (!value_->is_number() || !std::isfinite(value_->get<double>())) {
            throw error("a finite number");
        }
        return value_->get<double>();
    }
    [[nodiscard]] int count() const {
        if (!value_->is_number_integer() || value_->get<double>() < 0.0 || value_->get<double>() > 2e9) {
            throw error("a count");
        }
        return value_->get<int>();
    }
    [[nodiscard]] std::string text() const {
        if (!value_->is_string()) {
            throw error("a text");
        }
        return value_->get<std::string>();
    }
    [[nodiscard]] bool truth() const {
        if (!value_->is_boolean()) {
            throw error("true or false");
        }
        return value_->get<bool>();
    }
    [[nodiscard]] std::vector<Node> elements() const {
        if (!value_->is_array()) {
            throw error("a list");
        }
        std::vector<Node> nodes;
        for (std::size_t i = 0; i < value_->size(); ++i) {
            nodes.emplace_back((*value_)[i], file_, key_ + "[" + std::to_string(i) + "]");
        }
        return nodes;
    }
    [[nodiscard]] std::vector<double> numbers() const {
        std::vector<double> result;
        for (const Node& node : elements()) {
            result.push_back(node.number());
        }
        return result;
    }
    [[nodiscard]] std::vector<double> numbers(std::size_t count) const {
        std::vector<double> result = numbers();
        if (result.size() != count) {
            throw error("a list of " + std::to_string(count) + " numbers");
        }
        return result;
    }
    [[nodiscard]] Vec2d pair() const {
        const auto v = numbers(2);
        return {v[0], v[1]};
    }
    [[nodiscard]] Vec3d triple() const {
        const auto v = numbers(3);
        return {v[0], v[1], v[2]};
    }
    [[nodiscard]] std::vector<std::string> texts() const {
        std::vector<std::string> result;
        for (const Node& node : elements()) {
            result.push_back(node.text());
        }
        return result;
    }
    [[nodiscard]] std::vector<std::string> keys() const {
        if (!value_->is_object()) {
            throw error("an object");
        }
        std::vector<std::string> result;
        for (const auto& item : value_->items()) {
            result.push_back(item.key());
        }
        return result;
    }

  private:
    const Json* value_;
    std::string file_;
    std::string key_;
};

ProfileSource parse_source(const Node& node) {
    const std::string kind = node.at("kind").text();
    return {.kind = kind,
            .images = node.at("images").texts(),
            .camera = node.at("camera").text(),
            .lens = node.at("lens").text()};
}

CameraModel parse_model(const Node& node) {
    CameraModel model;
    const Node kind = node.at("kind");
    if (kind.text() == KannalaBrandt::kind) {
        model = KannalaBrandt{};
    } else if (kind.text() != BrownConrady::kind) {
        throw kind.error("\"" + std::string(BrownConrady::kind) + "\" or \"" + std::string(KannalaBrandt::kind) + "\"");
    }
    std::vector<double> values;
    for (const std::string& name : parameter_names(model)) {
        values.push_back(node.at("parameters").at(name).at("value").number());
    }
    if (!(values[0] > 0.0)) {
        throw node.at("parameters").at("focal_length_px").at("value").error("a positive length");
    }
    return with_parameters(model, values);
}

ProfileGeometry parse_geometry(const Node& root) {
    ProfileGeometry geometry;
    const Node model = root.at("model");
    geometry.model = parse_model(model);
    const std::vector<std::string> names = parameter_names(geometry.model);
    const Node order = model.at("covariance").at("parameter_order");
    if (order.texts() != names) {
        throw order.error("the parameters in the model's order");
    }
    const Node matrix = model.at("covariance").at("matrix");
    const std::vector<Node> rows = matrix.elements();
    if (rows.size() != names.size()) {
        throw matrix.error("a matrix of " + std::to_string(names.size()) + " rows");
    }
    for (const Node& row : rows) {
        const std::vector<double> values = row.numbers(names.size());
        geometry.covariance.insert(geometry.covariance.end(), values.begin(), values.end());
    }
    for (std::size_t i = 0; i < names.size(); ++i) {
        if (!(geometry.covariance[i * (names.size() + 1)] >= 0.0)) {
            throw matrix.error("variances that are not negative");
        }
    }
    geometry.reprojection_rms_px = root.at("reprojection_rms_px").number();
    geometry.views_used = root.at("views_used").count();
    geometry.points_used = root.at("points_used").count();
    geometry.covered_image_height = root.at("covered_image_height").number();
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
    ProfileView view{.image = node.at("image").text(), .found = node.at("found").truth(), .pose = {}, .points = {}};
    if (!view.found) {
        return view;
    }
    view.pose = {node.at("rotation_vector_rad").triple(), node.at("translation_mm").triple()};
    for (const Node& point : node.at("points").elements()) {
        view.points.push_back({.chart_mm = point.at("chart_mm").pair(),
                               .image_px = point.at("image_px").pair(),
                               .residual_px = point.at("residual_px").pair(),
                               .used = point.at("used").truth()});
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

Json parse_json(std::string_view text, const std::string& file) {
    try {
        return Json::parse(text);
    } catch (const Json::exception& e) {
        throw InputError(file + ": not JSON: " + e.what());
    }
}

}  // namespace

double ProfileGeometry::standard_error(std::size_t parameter) const {
    return std::sqrt(covariance[parameter * (parameters(model).size() + 1)]);
}

double half_diagonal_px(const Profile& profile) {
    return 0.5 * std::hypot(profile.width_px, profile.height_px);
}

Json to_json(const Profile& profile) {
    Json json;
    json["schema"] = kSchema;
    json["name"] = profile.name;
    json["source"] = source_json(profile.source);
    json["image_size_px"] = {profile.width_px, profile.height_px};
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
    }
    json["views"] = Json::array();
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
    json["not_measured"] = Json::object();
    for (const auto& [name, reason] : profile.not_measured) {
        json["not_measured"][name] = reason;
    }
    return json;
}

Profile parse_profile(std::string_view text, const std::string& file) {
    const Json json = parse_json(text, file);
    const Node root(json, file, "");
    const Node schema = root.at("schema");
    if (schema.text() != kSchema) {
        throw schema.error("\"" + std::string(kSchema) + "\"");
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
    if (const Node pitch = root.at("pixel_pitch_um"); !pitch.is_null()) {
        profile.pixel_pitch_um = pitch.number();
        if (!(*profile.pixel_pitch_um > 0.0)) {
            throw pitch.error("a positive length");
        }
    }
    if (root.has("model")) {
        profile.geometry = parse_geometry(root);
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
    const Node reasons = root.at("not_measured");
    for (const std::string& name : reasons.keys()) {
        profile.not_measured[name] = reasons.at(name).text();
    }
    return profile;
}

Profile read_profile(const std::filesystem::path& file) {
    return parse_profile(read_file(file), file.string());
}

void write_profile(const Profile& profile, const std::filesystem::path& file) {
    write_file(file, to_json(profile).dump(1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n");
}

}  // namespace lensproof
