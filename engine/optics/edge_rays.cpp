#include "engine/optics/edge_rays.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/optics/edge_diffraction.h"

namespace lensproof::optics {

namespace {

using std::numbers::pi;

/// A deflection with a density of 1/θ² between the zone's angles, to either side.
struct Deflection {
    double angle = 0.0;
    double density = 0.0;  // 1/rad
};

Deflection drawn_deflection(const EdgeZone& zone, double number) {
    const double side = number < 0.5 ? -1.0 : 1.0;
    const double share = std::abs(2.0 * number - 1.0);
    const double from = 1.0 / zone.smallest_angle;
    const double range = from - 1.0 / zone.largest_angle;
    const double angle = 1.0 / (from - share * range);
    return {.angle = side * angle, .density = 0.5 / (range * angle * angle)};
}

}  // namespace

std::optional<DiffractedRay> diffracted(const StopPlane& stop, const EdgeZone& zone, const Vec2d& point,
                                        const Vec3<double>& direction, const std::array<double, 3>& numbers) {
    const auto edges = stop.mask->edges_near(point.x / stop.semi_diameter, point.y / stop.semi_diameter, zone.width);
    if (edges.empty()) {
        return std::nullopt;
    }
    const auto count = static_cast<double>(edges.size());
    const auto chosen = std::min(edges.size() - 1, static_cast<std::size_t>(numbers[0] * count));
    const StopMask::NearEdge& edge = edges[chosen];
    if (!(numbers[1] < 1.0 - edge.distance / zone.width)) {
        return std::nullopt;
    }

    // The edge runs along t; across it lie the blade's direction o, in the stop's plane, and z.
    const Vec3<double> o{edge.outward.x, edge.outward.y, 0.0};
    const Vec3<double> t{-edge.outward.y, edge.outward.x, 0.0};
    const double along = dot(direction, t);
    const double across = std::sqrt(1.0 - along * along);
    // Azimuths about t from the blade's lit face, through the side that the light comes from.
    const double incidence = std::atan2(direction.z, -dot(direction, o));
    const Deflection deflection = drawn_deflection(zone, numbers[2]);
    const double leaving = incidence + pi + deflection.angle;
    const EdgeAngles angles{.incidence = incidence, .diffraction = leaving, .cone = std::acos(along)};
    const double power = keller_coefficients(angles, stop.wavenumber).unpolarised() * across * across;

    // The zone's strips grow narrower towards the inside of a curved edge. Light for a mm of edge is that for a mm²
    // across the ray.
    const double strip = 1.0 - edge.distance / edge.radius;
    const double for_edge = 2.0 / (zone.width * stop.semi_diameter) / strip / direction.z;
    return DiffractedRay{
        .direction = along * t + across * (std::cos(leaving) * o - std::sin(leaving) * Vec3<double>{0, 0, 1}),
        .weight = count * for_edge * power / deflection.density};
}

double diffracted_share(const StopPlane& stop, double angle) {
    const double perimeter = stop.mask->perimeter() * stop.semi_diameter;
    const double area = stop.mask->area() * stop.semi_diameter * stop.semi_diameter;
    return perimeter / (pi * stop.wavenumber * area * angle);
}

}  // namespace lensproof::optics
