#include "engine/optics/edge_rays.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/optics/edge_diffraction.h"

namespace lensproof::optics {

namespace {

using std::numbers::pi;

struct Deflection {
    double angle = 0.0;
    double density = 0.0;  // 1/rad
};

/// With a density of θ^(−3/2) between the range's ends.
Deflection drawn_deflection(const DeflectionRange& range, double number) {
    const double side = number < 0.5 ? -1.0 : 1.0;
    const double share = std::abs(2.0 * number - 1.0);
    const double from = 1.0 / std::sqrt(range.smallest);
    const double width = from - 1.0 / std::sqrt(range.largest);
    const double root = 1.0 / (from - share * width);
    return {.angle = side * root * root, .density = 0.25 / (width * root * root * root)};
}

}  // namespace

DiffractedRay diffracted_at_edge(const Vec2d& outward, double wavenumber, const Vec3<double>& direction,
                                 const DeflectionRange& deflections, double number) {
    // The edge runs along t; across it lie the blade's direction o, in the stop's plane, and z.
    const Vec3<double> o{outward.x, outward.y, 0.0};
    const Vec3<double> t{-outward.y, outward.x, 0.0};
    const double along = dot(direction, t);
    const double across = std::sqrt(1.0 - along * along);
    // Azimuths about t from the blade's lit face, through the side that the light comes from.
    const double incidence = std::atan2(direction.z, -dot(direction, o));
    const Deflection deflection = drawn_deflection(deflections, number);
    const double leaving = incidence + pi + deflection.angle;
    const EdgeAngles angles{.incidence = incidence, .diffraction = leaving, .cone = std::acos(along)};
    // Light for a mm of edge is that for a mm² across the ray.
    const double power = keller_coefficients(angles, wavenumber).unpolarised() * across * across / direction.z;
    return {.direction = along * t + across * (std::cos(leaving) * o - std::sin(leaving) * Vec3<double>{0, 0, 1}),
            .weight = power / deflection.density};
}

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
    DiffractedRay ray = diffracted_at_edge(edge.outward, stop.wavenumber, direction, zone.deflections, numbers[2]);
    // The zone's strips grow narrower towards the inside of a curved edge.
    const double strip = 1.0 - edge.distance / edge.radius;
    ray.weight *= count * 2.0 / (zone.width * stop.semi_diameter) / strip;
    return ray;
}

double diffracted_share(const StopPlane& stop, double angle) {
    const double perimeter = stop.mask->perimeter() * stop.semi_diameter;
    const double area = stop.mask->area() * stop.semi_diameter * stop.semi_diameter;
    return perimeter / (pi * stop.wavenumber * area * angle);
}

}  // namespace lensproof::optics
