#include "engine/analysis/distortion.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/optics/paraxial.h"

namespace lensproof::analysis {

namespace {

/// Of the plane `object_distance` in front of z = 0.
double paraxial_magnification(const optics::TraceLens<double>& lens, double object_distance) {
    // From z = 0 to the first vertex, which a moved group may have left it for.
    const double distance = object_distance + lens.surfaces.front().vertex_z;
    const int last = static_cast<int>(lens.surfaces.size()) - 1;
    return 1.0 / (distance * optics::trace_paraxial(lens, {1.0, 1.0 / distance}, 0, last).slope);
}

/// A grating turns the axis, differently for each colour: no projection counts from there.
bool has_gratings(const optics::TraceLens<double>& lens) {
    return std::ranges::any_of(lens.specials,
                               [](const optics::SpecialSurface<double>& each) { return each.thin.linear != 0.0; });
}

}  // namespace

std::optional<double> ideal_height(const optics::TraceLens<double>& lens, optics::Projection projection,
                                   const optics::FieldBundle& bundle) {
    const double field = bundle.chief.field_angle;
    const bool is_rectilinear = projection == optics::Projection::rectilinear;
    if (has_gratings(lens) || (is_rectilinear && !(std::abs(field) < 0.5 * std::numbers::pi))) {
        return std::nullopt;
    }
    const optics::ParaxialData first_order = optics::paraxial_data(lens);
    double height = first_order.front_efl * optics::projected_radius(projection, field);
    if (bundle.is_near()) {
        const double magnification = paraxial_magnification(lens, bundle.object_distance);
        const double focal =
            -magnification * (bundle.object_distance + lens.surfaces.front().vertex_z + first_order.entrance_pupil_z);
        height = is_rectilinear ? magnification * bundle.object_point().y
                                : focal * optics::projected_radius(projection, field);
    }
    return std::isfinite(height) ? std::optional(height) : std::nullopt;
}

double distortion_plane(const optics::TraceLens<double>& reference, double object_distance) {
    const double image =
        optics::paraxial_image_distance(reference, object_distance + reference.surfaces.front().vertex_z);
    return std::isfinite(image) ? reference.surfaces.back().vertex_z + image : reference.image_z;
}

std::optional<double> distortion_percent(const optics::TraceLens<double>& lens, optics::Projection projection,
                                         const optics::FieldBundle& bundle, double plane_z) {
    const std::optional<double> ideal = ideal_height(lens, projection, bundle);
    const optics::TracedRay<double> chief = optics::trace_past_rims(lens, bundle.ray({}));
    if (!ideal || !optics::gets_through(chief.status)) {
        return std::nullopt;
    }
    if (bundle.chief.field_angle == 0.0) {
        return 0.0;
    }
    const double percent = 100.0 * (optics::meet_plane(chief.ray, plane_z).point.y / *ideal - 1.0);
    return std::isfinite(percent) ? std::optional(percent) : std::nullopt;
}

}  // namespace lensproof::analysis
