#include "engine/optics/pupil_bounds.h"

#include <algorithm>
#include <cmath>

namespace lensproof {

namespace {

/// z of the circle where the rear surface ends. Every path that leaves the element passes inside that circle.
double rear_rim_z(const TraceLens<double>& lens) {
    const TraceSurface<double>& rear = lens.surfaces.back();
    const double c = rear.curvature;
    const double r2 = rear.semi_diameter_squared;
    const double root = 1.0 - c * c * r2;
    return rear.vertex_z + (root > 0.0 ? c * r2 / (1.0 + std::sqrt(root)) : 1.0 / c);
}

double rear_radius(const TraceLens<double>& lens) {
    return std::sqrt(lens.surfaces.back().semi_diameter_squared);
}

/// |x| ≤ half_width by the lens's symmetry.
struct Rectangle {
    double half_width;
    double y_min;
    double y_max;
};

/// Cells of a grid (their centres, x ≥ 0) through which a sensor point sees the scene.
struct PassingCells {
    std::vector<Vec2d> centres;
    Vec2d cell;

    /// The smallest rectangle around the cells, widened by a cell.
    [[nodiscard]] Rectangle bounds() const {
        Rectangle found{.half_width = 0.0, .y_min = centres.front().y, .y_max = centres.front().y};
        for (const Vec2d& centre : centres) {
            found.half_width = std::max(found.half_width, centre.x + 1.5 * cell.x);
            found.y_min = std::min(found.y_min, centre.y - 1.5 * cell.y);
            found.y_max = std::max(found.y_max, centre.y + 1.5 * cell.y);
        }
        return found;
    }
};

bool passes(const TraceLens<double>& lens, double sensor_radius, Vec2d at, double plane_z) {
    const Vec3d from{0.0, sensor_radius, lens.image_z};
    const Vec3d direction = normalized(Vec3d{at.x, at.y, plane_z} - from);
    return trace<Direction::reverse>(lens, Ray<double>{from, direction}).status == RayStatus::ok;
}

PassingCells passing_cells(const TraceLens<double>& lens, double sensor_radius, double plane_z,
                           const Rectangle& searched) {
    constexpr int kCells = 32;
    PassingCells found{.centres = {},
                       .cell = {searched.half_width / kCells, (searched.y_max - searched.y_min) / kCells}};
    for (int i = 0; i < kCells; ++i) {
        for (int k = 0; k < kCells; ++k) {
            const Vec2d centre{found.cell.x * (i + 0.5), searched.y_min + found.cell.y * (k + 0.5)};
            if (passes(lens, sensor_radius, centre, plane_z)) {
                found.centres.push_back(centre);
            }
        }
    }
    return found;
}

/// The corners of all cells, and one cell more on the outside.
void append_outlines(const PassingCells& cells, std::vector<Vec2d>& outline) {
    for (const Vec2d& centre : cells.centres) {
        for (const double side : {-1.5, 1.5}) {
            outline.push_back({centre.x + 1.5 * cells.cell.x, centre.y + side * cells.cell.y});
        }
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

PupilBounds::PupilBounds(const std::vector<TraceLens<double>>& lenses, double largest_radius_mm, int ranges) {
    const double radius = rear_radius(lenses.front());
    const Rectangle whole{.half_width = radius, .y_min = -radius, .y_max = radius};
    plane_z_ = rear_rim_z(lenses.front());
    ranges_per_mm_ = ranges / largest_radius_mm;

    // Outlines at the ends and middles of the ranges, from the axis outwards; empty where some wavelength does not
    // pass.
    std::vector<std::vector<Vec2d>> outlines(2 * static_cast<std::size_t>(ranges) + 1);
    for (std::size_t i = 0; i < outlines.size(); ++i) {
        const double sensor_radius = 0.5 * static_cast<double>(i) / ranges_per_mm_;
        for (const TraceLens<double>& lens : lenses) {
            const PassingCells coarse = passing_cells(lens, sensor_radius, plane_z_, whole);
            if (coarse.centres.empty()) {
                outlines[i].clear();
                break;
            }
            append_outlines(passing_cells(lens, sensor_radius, plane_z_, coarse.bounds()), outlines[i]);
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

PupilBounds PupilBounds::whole_element(const TraceLens<double>& lens) {
    PupilBounds bounds;
    const double radius = rear_radius(lens);
    bounds.ellipses_ = {PupilEllipse{0.0, radius, radius}};
    bounds.plane_z_ = rear_rim_z(lens);
    return bounds;
}

}  // namespace lensproof
