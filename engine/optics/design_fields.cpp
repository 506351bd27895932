#include "engine/optics/design_fields.h"

#include <algorithm>
#include <cmath>

#include "engine/base/angle.h"
#include "engine/base/bisect.h"
#include "engine/optics/paraxial.h"

namespace lensproof::optics {

namespace {

/// How far off the axis, with y's sign where x is 0.
double signed_length(const Vec2d& point) {
    return point.x == 0.0 ? point.y : std::hypot(point.x, point.y);
}

/// The slope of the chief ray from a paraxial image height.
double paraxial_slope(double image_height, const TraceLens<double>& lens, double object_distance) {
    const ParaxialData data = paraxial_data(lens);
    if (std::isinf(object_distance)) {
        return image_height / data.front_efl;
    }
    const double object_height = image_height / paraxial_conjugates(lens, object_distance).magnification;
    return -object_height / (object_distance + data.entrance_pupil_z);
}

}  // namespace

double oblique_angle_deg(const Vec2d& angles_deg) {
    const auto [x, y] = angles_deg;
    const bool is_oblique = x != 0.0 && y != 0.0 && std::abs(x) < 90.0 && std::abs(y) < 90.0;
    return is_oblique ? std::atan(std::hypot(std::tan(x * kDegree), std::tan(y * kDegree))) / kDegree
                      : signed_length(angles_deg);
}

double field_at_image_height(const ChiefRays& chief_rays, double height_mm) {
    constexpr int kHalvings = 52;
    const auto is_inside = [&](double field) {
        const auto chief = chief_rays.at_field(field);
        return chief && length(chief->image_point) < height_mm;
    };
    return bisected({0.0, chief_rays.largest_field()}, kHalvings, is_inside).outside;
}

std::optional<double> field_angle(FieldKind kind, const Vec2d& point, const TraceLens<double>& lens,
                                  const ChiefRays& chief_rays, double object_distance_mm) {
    const double height = signed_length(point);
    double angle = 0.0;
    if (kind == FieldKind::angle) {
        angle = oblique_angle_deg(point) * kDegree;
    } else if (height == 0.0) {
        return 0.0;
    } else if (kind == FieldKind::object_height) {
        const auto chief =
            std::isfinite(object_distance_mm) ? chief_rays.from_point(height, -object_distance_mm) : std::nullopt;
        return chief ? std::optional(chief->field_angle) : std::nullopt;
    } else if (kind == FieldKind::paraxial_image_height) {
        angle = std::atan(paraxial_slope(height, lens, object_distance_mm));
    } else {
        angle = std::copysign(field_at_image_height(chief_rays, std::abs(height)), height);
    }
    return chief_rays.at_field(angle) ? std::optional(angle) : std::nullopt;
}

std::vector<double> design_fields_deg(const Prescription& prescription, const Lens& lens, double wavelength_nm,
                                      double object_distance_mm) {
    const DesignFields& design = prescription.fields;
    if (design.points.empty()) {
        return {};
    }
    const ChiefRays chief_rays(lens, wavelength_nm, Rims::follow);
    const auto traced = at_wavelength<double>(lens, wavelength_nm);
    std::vector<double> fields;
    for (const Vec2d& point : design.points) {
        const std::optional<double> angle = field_angle(design.kind, point, traced, chief_rays, object_distance_mm);
        if (!angle) {
            continue;
        }
        // An angle is kept as it is written: 20 stays 20.
        const double exact = design.kind == FieldKind::angle ? oblique_angle_deg(point) : degrees(*angle);
        const double field = lens.is_rotationally_symmetric ? std::abs(exact) : exact;
        if (std::ranges::find(fields, field) == fields.end()) {
            fields.push_back(field);
        }
    }
    return fields;
}

}  // namespace lensproof::optics
