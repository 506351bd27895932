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
    const double fraction = std::abs(2.0 * number - 1.0);
    const double from = 1.0 / std::sqrt(range.smallest);
    const double width = from - 1.0 / std::sqrt(range.largest);
    const double root = 1.0 / (from - fraction * width);
    return {.angle = side * root * root, .density = 0.25 / (width * root * root * root)};
}

/// ∫ sin²x / x² from 0 to `end`, to 2e-4: by its series where that is short, beyond by its asymptotic expansion.
double sinc_squared_within(double end) {
    if (end > 5.0) {
        const double x2 = end * end;
        return 0.5 * pi - 0.5 / end - std::sin(2.0 * end) / (4.0 * x2) * (1.0 - 1.5 / x2) +
               std::cos(2.0 * end) / (4.0 * x2 * end) * (1.0 - 3.0 / x2);
    }
    double term = end;  // (−1)^(n+1) 2^(2n−1) end^(2n−1) / (2n)!
    double sum = end;
    for (int n = 2; std::abs(term) > 1e-9; ++n) {
        term *= -4.0 * end * end / ((2.0 * n) * (2.0 * n - 1.0));
        sum += term / (2.0 * n - 1.0);
    }
    return sum;
}

/// A number from −1 to 1 with the density of sinc²(reach · number).
struct Turn {
    double sine = 0.0;
    double weight = 1.0;  // from 0 to 4/π, 1 in the mean
};

/// Drawn below the envelope min(1, 1/x²).
Turn drawn_turn(double reach, double number) {
    const double side = number < 0.5 ? -1.0 : 1.0;
    const double envelope = reach < 1.0 ? reach : 2.0 - 1.0 / reach;
    const double fraction = std::abs(2.0 * number - 1.0) * envelope;
    const double x = fraction < 1.0 ? fraction : 1.0 / (2.0 - fraction);
    const double root = x > 0.0 ? std::sin(x) / std::min(x, 1.0) : 1.0;  // of sinc² over the envelope
    return {.sine = side * x / reach, .weight = root * root * envelope / sinc_squared_within(reach)};
}

}  // namespace

DiffractedRay diffracted_at_edge(const StopEdge& edge, double wavenumber, const Vec3<double>& direction,
                                 const DeflectionRange& deflections, const std::array<double, 2>& numbers) {
    // The edge runs along t; across it lie the blade's direction o, in the stop's plane, and z.
    const Vec3<double> o{edge.outward.x, edge.outward.y, 0.0};
    const Vec3<double> t{-edge.outward.y, edge.outward.x, 0.0};
    const double along = dot(direction, t);
    const double across = std::sqrt(1.0 - along * along);
    // Azimuths about t from the blade's lit face, through the side that the light comes from.
    const double incidence = std::atan2(direction.z, -dot(direction, o));
    const Deflection deflection = drawn_deflection(deflections, numbers[0]);
    const EdgeAngles angles{
        .incidence = incidence, .diffraction = incidence + pi + deflection.angle, .cone = std::acos(along)};
    // Light for a mm of edge is that for a mm² across the ray.
    const double power = keller_coefficients(angles, wavenumber).unpolarised() * across * across / direction.z;

    const double sine = std::sin(std::abs(deflection.angle));
    const Turn turn = std::isinf(edge.length) ? Turn{} : drawn_turn(0.5 * wavenumber * sine * edge.length, numbers[1]);
    const double turned_along = along + sine * turn.sine;
    if (!(std::abs(turned_along) < 1.0)) {
        return {};
    }
    const double turned_across = std::sqrt(1.0 - turned_along * turned_along);
    const double leaving = incidence + pi + deflection.angle * std::sqrt(1.0 - turn.sine * turn.sine);
    return {.direction =
                turned_along * t + turned_across * (std::cos(leaving) * o - std::sin(leaving) * Vec3<double>{0, 0, 1}),
            .weight = power / deflection.density * turn.weight};
}

std::optional<DiffractedRay> diffracted(const StopPlane& stop, const EdgeZone& zone, const Vec2d& point,
                                        const Vec3<double>& direction, const std::array<double, 4>& numbers) {
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
    DiffractedRay ray = diffracted_at_edge({edge.outward, edge.length * stop.semi_diameter}, stop.wavenumber, direction,
                                           zone.deflections, {numbers[2], numbers[3]});
    // The zone's strips grow narrower towards the inside of a curved edge.
    const double strip = 1.0 - edge.distance / edge.radius;
    ray.weight *= count * 2.0 / (zone.width * stop.semi_diameter) / strip;
    return ray;
}

double diffracted_fraction(const StopPlane& stop, double angle) {
    const double perimeter = stop.mask->perimeter() * stop.semi_diameter;
    const double area = stop.mask->area() * stop.semi_diameter * stop.semi_diameter;
    return perimeter / (pi * stop.wavenumber * area * angle);
}

}  // namespace lensproof::optics
