#include "engine/optics/pupil_bounds.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace lensproof {

namespace {

// Between two azimuths of an outline a circle bulges by (π/96)² / 2 = 0.05 %; between two radii of the sensor the
// outline moves smoothly, and both ends and the middle are looked at.
constexpr double kMargin = 1.003;

/// The farthest z of the circle where the rear surface ends. Every path that leaves the element passes inside that
/// circle.
double rear_rim_z(const TraceLens<double>& lens) {
    const TraceSurface<double>& rear = lens.surfaces.back();
    SurfaceShape<double> shape{.curvature = rear.curvature};
    if (rear.special >= 0 && lens.specials[rear.special].has_shape) {
        shape = lens.specials[rear.special].shape;
    }
    const double radius = std::sqrt(rear.semi_diameter_squared);
    double z = -std::numeric_limits<double>::infinity();
    for (const Vec2d rim : {Vec2d{radius, 0.0}, Vec2d{0.0, radius}}) {
        const double at_rim = sag(shape, rim.x, rim.y);
        z = std::max(z, std::isfinite(at_rim) ? at_rim : 1.0 / rear.curvature);  // beyond the equator
    }
    return rear.vertex_z + z;
}

/// A lens with its stop opened to the full circle, which holds what any blades leave.
TraceLens<double> with_round_stop(TraceLens<double> lens) {
    for (SpecialSurface<double>& special : lens.specials) {
        special.mask = {};
    }
    return lens;
}

double rear_radius(const TraceLens<double>& lens) {
    return std::sqrt(lens.surfaces.back().semi_diameter_squared);
}

bool passes(const TraceLens<double>& lens, double sensor_radius, Vec2d at, double plane_z) {
    const Vec3d from{0.0, sensor_radius, lens.image_z};
    const Vec3d direction = normalized(Vec3d{at.x, at.y, plane_z} - from);
    return trace<Direction::reverse>(lens, Ray<double>{from, direction}).status == RayStatus::ok;
}

/// The mean of the passing points on a grid over the rear element, which by symmetry lies on x = 0; nothing where none
/// passes.
std::optional<double> passing_centre(const TraceLens<double>& lens, double sensor_radius, double plane_z) {
    const double radius = rear_radius(lens);
    for (const int cells : {24, 96}) {
        double sum = 0.0;
        int passed = 0;
        for (int i = 0; i < cells / 2; ++i) {
            for (int k = 0; k < cells; ++k) {
                const Vec2d at{2.0 * radius * (i + 0.5) / cells, radius * (2.0 * (k + 0.5) / cells - 1.0)};
                if (passes(lens, sensor_radius, at, plane_z)) {
                    sum += at.y;
                    ++passed;
                }
            }
        }
        if (passed > 0 && passes(lens, sensor_radius, {0.0, sum / passed}, plane_z)) {
            return sum / passed;
        }
    }
    return std::nullopt;
}

/// Appends the half outline (x ≥ 0) of the passing region, found by bisection outwards from its centre.
void append_outline(const TraceLens<double>& lens, double sensor_radius, double plane_z, double centre_y,
                    std::vector<Vec2d>& outline) {
    constexpr int kAzimuths = 48;
    constexpr int kHalvings = 20;
    for (int i = 0; i <= kAzimuths; ++i) {
        const double azimuth = std::numbers::pi * (static_cast<double>(i) / kAzimuths - 0.5);
        const auto at = [&](double distance) {
            return Vec2d{distance * std::cos(azimuth), centre_y + distance * std::sin(azimuth)};
        };
        double inside = 0.0;
        double outside = 2.0 * rear_radius(lens);
        for (int halving = 0; halving < kHalvings; ++halving) {
            const double middle = 0.5 * (inside + outside);
            (passes(lens, sensor_radius, at(middle), plane_z) ? inside : outside) = middle;
        }
        outline.push_back(at(outside));
    }
}

/// An ellipse around all points and their mirror images: shaped like their bounding box, as large as the farthest
/// needs.
PupilEllipse enclosing_ellipse(const std::vector<Vec2d>& points) {
    double half_width = 0.0;
    double y_min = points.front().y;
    double y_max = points.front().y;
    for (const Vec2d& point : points) {
        half_width = std::max(half_width, point.x);
        y_min = std::min(y_min, point.y);
        y_max = std::max(y_max, point.y);
    }
    const double centre_y = 0.5 * (y_min + y_max);
    const double half_height = 0.5 * (y_max - y_min);
    double scale = 0.0;
    for (const Vec2d& point : points) {
        scale = std::max(scale, std::hypot(point.x / half_width, (point.y - centre_y) / half_height));
    }
    scale *= kMargin;
    return {.centre_y = centre_y, .semi_axis_x = scale * half_width, .semi_axis_y = scale * half_height};
}

}  // namespace

Vec2d PupilEllipse::warped(double u, double v) const {
    const double a = 2.0 * u - 1.0;
    const double b = 2.0 * v - 1.0;
    if (a == 0.0 && b == 0.0) {
        return {0.0, centre_y};
    }
    constexpr double kQuarter = 0.25 * std::numbers::pi;
    const bool wide = std::abs(a) > std::abs(b);
    const double radius = wide ? a : b;
    const double angle = wide ? kQuarter * b / a : kQuarter * (2.0 - a / b);
    return {semi_axis_x * radius * std::cos(angle), centre_y + semi_axis_y * radius * std::sin(angle)};
}

PupilBounds::PupilBounds(std::vector<TraceLens<double>> lenses, double largest_radius_mm, int ranges) {
    std::ranges::transform(lenses, lenses.begin(), with_round_stop);
    const double radius = rear_radius(lenses.front());
    plane_z_ = rear_rim_z(lenses.front());
    ranges_per_mm_ = ranges / largest_radius_mm;

    // Outlines at the ends and middles of the ranges, from the axis outwards; empty where some wavelength does not
    // pass.
    std::vector<std::vector<Vec2d>> outlines(2 * static_cast<std::size_t>(ranges) + 1);
    for (std::size_t i = 0; i < outlines.size(); ++i) {
        const double sensor_radius = 0.5 * static_cast<double>(i) / ranges_per_mm_;
        for (const TraceLens<double>& lens : lenses) {
            const std::optional<double> centre_y = passing_centre(lens, sensor_radius, plane_z_);
            if (!centre_y) {
                outlines[i].clear();
                break;
            }
            append_outline(lens, sensor_radius, plane_z_, *centre_y, outlines[i]);
        }
    }
    for (std::size_t i = 0; i + 2 < outlines.size(); i += 2) {
        std::vector<Vec2d> joined;
        bool complete = true;
        for (std::size_t k = i; k <= i + 2; ++k) {
            complete = complete && !outlines[k].empty();
            joined.insert(joined.end(), outlines[k].begin(), outlines[k].end());
        }
        ellipses_.push_back(complete ? enclosing_ellipse(joined) : PupilEllipse{0.0, radius, radius});
    }
}

PupilBounds PupilBounds::whole_element(const TraceLens<double>& lens, double sensor_radius_mm) {
    PupilBounds bounds;
    double radius = rear_radius(lens);
    bounds.plane_z_ = rear_rim_z(lens);
    const TraceSurface<double>& rear = lens.surfaces.back();
    if (rear.special >= 0) {
        // Paths may run from the sensor's disc to a rim that lies askew: the plane through the rim's nearest point, and
        // a disc there that holds both.
        const SpecialSurface<double>& special = lens.specials[rear.special];
        const double rim_z = bounds.plane_z_ - rear.vertex_z;
        bounds.plane_z_ = -std::numeric_limits<double>::infinity();
        constexpr int kAzimuths = 64;
        double rim_radius = sensor_radius_mm;
        for (int i = 0; i < kAzimuths; ++i) {
            const double azimuth = 2.0 * std::numbers::pi * i / kAzimuths;
            const Vec3d rim = special.from_own({radius * std::cos(azimuth), radius * std::sin(azimuth), rim_z});
            bounds.plane_z_ = std::max(bounds.plane_z_, rear.vertex_z + rim.z);
            rim_radius = std::max(rim_radius, std::hypot(rim.x + special.vertex.x, rim.y + special.vertex.y));
        }
        radius = kMargin * rim_radius;
    }
    bounds.ellipses_ = {PupilEllipse{0.0, radius, radius}};
    return bounds;
}

}  // namespace lensproof
