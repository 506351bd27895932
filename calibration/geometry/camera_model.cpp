#include "calibration/geometry/camera_model.h"

#include <ceres/jet.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "engine/base/infinity.h"

namespace lensproof::calibration {
namespace {

constexpr double kScanStep = kDegree;  // no 4-term polynomial folds and unfolds within a degree
constexpr int kFoldSteps = 64;         // a fold is located to 1/64°

double largest_angle(const CameraModel& model) {
    return std::visit([](const auto& m) { return m.largest_angle; }, model);
}

// Every kind of model once, without distortion.
template <std::size_t... kind>
std::array<CameraModel, sizeof...(kind)> make_all(std::index_sequence<kind...> /*kinds*/) {
    return {CameraModel(std::in_place_index<kind>)...};
}

std::array<CameraModel, std::variant_size_v<CameraModel>> all_models() {
    return make_all(std::make_index_sequence<std::variant_size_v<CameraModel>>());
}

Vec3d direction(double angle, double azimuth_x, double azimuth_y) {
    return {std::sin(angle) * azimuth_x, std::sin(angle) * azimuth_y, std::cos(angle)};
}

// Angles whose radii enclose the one looked for.
struct AngleBracket {
    double low = 0.0;
    double high = 0.0;
};

// Walks outwards until r(θ) passes `radius`; none when it folds back or ends before.
std::optional<AngleBracket> bracket_angle(const CameraModel& model, double radius) {
    const double end = largest_angle(model);
    double step = kScanStep;
    AngleBracket bracket;
    double previous = 0.0;
    for (double reached = 0.0; reached < radius;) {
        const double next = std::min(bracket.high + step, end);
        reached = radius_px(model, next);
        if (!(reached > previous)) {
            if (step < kScanStep || bracket.high >= end) {
                return std::nullopt;
            }
            // The fold lies in this step or the last: walk both again with small steps.
            step = kScanStep / kFoldSteps;
            bracket.high = bracket.low;
            previous = reached = radius_px(model, bracket.low);
            continue;
        }
        bracket = {bracket.high, next};
        previous = reached;
    }
    return bracket;
}

// False position with the Illinois modification (Dowell & Jarratt 1971): as safe as halving, and superlinear.
double angle_within(const CameraModel& model, double radius, AngleBracket bracket) {
    double below = radius_px(model, bracket.low) - radius;
    double above = radius_px(model, bracket.high) - radius;
    double angle = bracket.high;
    for (int iteration = 0; iteration < 100 && below < 0.0 && above > 0.0; ++iteration) {
        angle = (bracket.low * above - bracket.high * below) / (above - below);
        if (!(angle > bracket.low && angle < bracket.high)) {
            break;  // the bracket has shrunk to rounding
        }
        const double difference = radius_px(model, angle) - radius;
        if (difference == 0.0) {
            return angle;
        }
        if (difference < 0.0) {
            bracket.low = angle;
            below = difference;
            above *= 0.5;
        } else {
            bracket.high = angle;
            above = difference;
            below *= 0.5;
        }
    }
    return radius > 0.0 ? angle : 0.0;
}

// Newton's method for the direction (x, y, 1) from a start that ignores the tangential terms.
template <class Model>
std::optional<Vec3d> unproject_newton(const Model& model, const Vec2d& pixel, double x, double y) {
    using Jet = ceres::Jet<double, 2>;
    std::array<Jet, Model::count> parameters;
    std::transform(model.parameters.begin(), model.parameters.end(), parameters.begin(),
                   [](double p) { return Jet(p); });
    double last_step = 1e300;
    for (int iteration = 0; iteration < 50; ++iteration) {
        Vec2<Jet> image;
        Model::project(parameters.data(), Vec3<Jet>{Jet(x, 0), Jet(y, 1), Jet(1.0)}, image);
        const double ex = image.x.a - pixel.x;
        const double ey = image.y.a - pixel.y;
        const double determinant = image.x.v[0] * image.y.v[1] - image.x.v[1] * image.y.v[0];
        if (!(std::abs(determinant) > 0.0)) {
            return std::nullopt;
        }
        const double dx = (ex * image.y.v[1] - ey * image.x.v[1]) / determinant;
        const double dy = (ey * image.x.v[0] - ex * image.y.v[0]) / determinant;
        x -= dx;
        y -= dy;
        const double step = std::hypot(dx, dy);
        if (step == 0.0 || (step < 1e-9 && step >= 0.5 * last_step)) {
            return normalized(Vec3d{x, y, 1.0});  // quadratic convergence has ended in rounding
        }
        last_step = step;
    }
    return std::nullopt;
}

constexpr double kRadiiPerPixel = 4.0;  // in the table of field angles

// The direction that `pixel` shows; `angle_of` says at which field angle the model images a radius, if at any.
template <class AngleOf>
std::optional<Vec3d> unproject_with(const CameraModel& model, const Vec2d& pixel, const AngleOf& angle_of) {
    const Vec2d centre = centre_px(model);
    const double dx = pixel.x - centre.x;
    const double dy = (pixel.y - centre.y) / (1.0 + stretch_y(model));
    const double radius = std::hypot(dx, dy);
    const auto angle = angle_of(radius);
    if (!angle) {
        return std::nullopt;
    }
    const double azimuth_x = radius > 0.0 ? dx / radius : 1.0;
    const double azimuth_y = radius > 0.0 ? dy / radius : 0.0;
    return std::visit(
        [&]<class Model>(const Model& m) -> std::optional<Vec3d> {
            if constexpr (!Model::tangential_terms.empty()) {
                if (m.parameters[6] != 0.0 || m.parameters[7] != 0.0) {
                    return unproject_newton(m, pixel, std::tan(*angle) * azimuth_x, std::tan(*angle) * azimuth_y);
                }
            }
            return direction(*angle, azimuth_x, azimuth_y);
        },
        model);
}

}  // namespace

std::vector<std::string> model_kind_names() {
    std::vector<std::string> names;
    for (const CameraModel& model : all_models()) {
        names.push_back(kind_name(model));
    }
    return names;
}

std::optional<ModelKind> model_kind(std::string_view name) {
    for (const CameraModel& model : all_models()) {
        if (kind_name(model) == name) {
            return kind(model);
        }
    }
    return std::nullopt;
}

ModelKind kind(const CameraModel& model) {
    return static_cast<ModelKind>(model.index());
}

CameraModel empty_model(ModelKind kind) {
    return all_models()[static_cast<std::size_t>(kind)];
}

std::string kind_name(const CameraModel& model) {
    return std::visit([](const auto& m) { return std::string(m.kind); }, model);
}

std::vector<std::string> parameter_names(const CameraModel& model) {
    return std::visit([](const auto& m) { return std::vector<std::string>(m.names.begin(), m.names.end()); }, model);
}

std::vector<double> parameters(const CameraModel& model) {
    return std::visit([](const auto& m) { return std::vector<double>(m.parameters.begin(), m.parameters.end()); },
                      model);
}

CameraModel with_parameters(const CameraModel& model, const std::vector<double>& values) {
    CameraModel result = model;
    std::visit(
        [&](auto& m) {
            std::copy_n(values.begin(), std::min(values.size(), m.parameters.size()), m.parameters.begin());
        },
        result);
    return result;
}

ModelTerms model_terms(const CameraModel& model) {
    return std::visit(
        [](const auto& m) {
            return ModelTerms{{m.radial_terms.begin(), m.radial_terms.end()},
                              {m.tangential_terms.begin(), m.tangential_terms.end()}};
        },
        model);
}

bool is_perspective(const CameraModel& model) {
    return model.index() <= static_cast<std::size_t>(ModelKind::ptlens);
}

double focal_length_px(const CameraModel& model) {
    return std::visit([](const auto& m) { return m.parameters[0]; }, model);
}

double stretch_y(const CameraModel& model) {
    return std::visit([](const auto& m) { return m.parameters.back(); }, model);
}

Vec2d centre_px(const CameraModel& model) {
    return std::visit([](const auto& m) { return Vec2d{m.parameters[1], m.parameters[2]}; }, model);
}

std::optional<Vec2d> project(const CameraModel& model, const Vec3d& point) {
    Vec2d pixel;
    const bool imaged = std::visit([&](const auto& m) { return m.project(m.parameters.data(), point, pixel); }, model);
    return imaged ? std::optional(pixel) : std::nullopt;
}

double radius_px(const CameraModel& model, double angle_rad) {
    return std::visit([&](const auto& m) { return m.radius(m.parameters.data(), angle_rad); }, model);
}

double undistorted_angle_rad(ModelKind kind, double focal_px, double radius_px) {
    return std::visit([&](const auto& m) { return m.undistorted_angle(focal_px, radius_px); }, empty_model(kind));
}

std::optional<double> field_angle_rad(const CameraModel& model, double radius) {
    if (!(radius >= 0.0) || !std::isfinite(radius)) {
        return std::nullopt;
    }
    const auto bracket = bracket_angle(model, radius);
    return bracket ? std::optional(angle_within(model, radius, *bracket)) : std::nullopt;
}

FieldAngles::FieldAngles(const CameraModel& model, double largest_radius_px) {
    const auto count = static_cast<std::size_t>(std::ceil(kRadiiPerPixel * largest_radius_px)) + 2;
    angles_.reserve(count);
    for (std::size_t i = 0; i < count; ++i) {
        angles_.push_back(field_angle_rad(model, static_cast<double>(i) / kRadiiPerPixel).value_or(kNaN));
    }
}

std::optional<double> FieldAngles::at(double radius_px) const {
    const double place = kRadiiPerPixel * radius_px;
    if (!(place >= 0.0 && place < static_cast<double>(angles_.size() - 1))) {
        return std::nullopt;
    }
    const auto i = static_cast<std::size_t>(place);
    const double angle = std::lerp(angles_[i], angles_[i + 1], place - static_cast<double>(i));
    return std::isnan(angle) ? std::nullopt : std::optional(angle);
}

std::optional<Vec3d> unproject(const CameraModel& model, const Vec2d& pixel) {
    return unproject_with(model, pixel, [&](double radius) { return field_angle_rad(model, radius); });
}

std::optional<Vec3d> unproject(const CameraModel& model, const Vec2d& pixel, const FieldAngles& angles) {
    return unproject_with(model, pixel, [&](double radius) { return angles.at(radius); });
}

}  // namespace lensproof::calibration
