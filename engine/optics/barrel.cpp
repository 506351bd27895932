#include "engine/optics/barrel.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/base/input_error.h"

namespace lensproof::optics {

namespace {

/// The mechanical semi-diameter. A stop's own says nothing of the tube around it: that runs on between its neighbours.
double rim_of(const Lens& lens, std::size_t i) {
    const LensSurface& surface = lens.surfaces[i];
    const double rim = std::max(surface.semi_diameter, surface.rim);
    if (!surface.is_stop || surface.rim > 0.0 || lens.surfaces.size() == 1) {
        return rim;
    }
    const std::size_t before = i > 0 ? i - 1 : i + 1;
    const std::size_t behind = i + 1 < lens.surfaces.size() ? i + 1 : i - 1;
    const double from = rim_of(lens, before);
    const double gap = lens.surfaces[behind].vertex_z - lens.surfaces[before].vertex_z;
    const double fraction = gap > 0.0 ? (surface.vertex_z - lens.surfaces[before].vertex_z) / gap : 0.0;
    return std::max(rim, from + std::clamp(fraction, 0.0, 1.0) * (rim_of(lens, behind) - from));
}

double edge_z(const LensSurface& surface) {
    const SurfaceShape<double> shape =
        surface.has_shape ? surface.shape : SurfaceShape<double>{.curvature = surface.curvature};
    const double height = sag(shape, surface.semi_diameter, 0.0);
    return surface.vertex_z + (std::isfinite(height) ? height : 1.0 / shape.curvature);  // a hemisphere's equator
}

bool is_glass(const Glass& medium) {
    return medium.formula != DispersionFormula(ConstantIndex{1.0});
}

}  // namespace

Barrel::Barrel(const Lens& lens) : finish_(lens.barrel), dust_(lens.dust) {
    const bool is_known = lens.is_rotationally_symmetric && !lens.has_mirrors() && !lens.has_thin_elements() &&
                          !is_glass(lens.object_medium);
    if (!is_known && finish_.is_black()) {
        return;  // which ends all light just so
    }
    require_refraction_alone(lens, "a barrel that scatters");
    if (!lens.is_rotationally_symmetric) {
        throw InputError(
            fmt::format("{}: a barrel that scatters is known about one axis alone; some surface of this "
                        "lens is no surface of revolution about it",
                        lens.name));
    }
    for (std::size_t i = 0; i + 1 < lens.surfaces.size(); ++i) {
        const auto ring = [&](std::size_t at) {
            const LensSurface& surface = lens.surfaces[at];
            return Ring{.z = edge_z(surface),
                        .inner = surface.semi_diameter,
                        .outer = rim_of(lens, at),
                        .finish = surface.is_stop ? finish_.blades : finish_.tube,
                        .is_blades = surface.is_stop && lens.medium_before(at).formula == surface.medium.formula};
        };
        Cell cell{.front = ring(i),
                  .rear = ring(i + 1),
                  .around = is_glass(lens.surfaces[i].medium) ? finish_.edges : finish_.tube};
        if (const double tube = lens.surfaces[i].tube_behind; tube > 0.0) {
            cell.front.outer = cell.rear.outer = std::max({tube, cell.front.inner, cell.rear.inner});
        }
        cells_.push_back(cell);
    }
}

std::optional<WallMeeting> Barrel::meet(int cell, const Ray<double>& ray) const {
    if (cell < 1 || cell > static_cast<int>(cells_.size())) {
        return std::nullopt;
    }
    const auto& [front, rear, around] = cells_[static_cast<std::size_t>(cell - 1)];
    const Vec3d& o = ray.origin;
    const Vec3d& d = ray.direction;
    std::optional<WallMeeting> nearest;
    const auto take = [&](double distance, const Vec3d& normal, const WallFinish& finish, bool is_blades) {
        if (distance > 0.0 && (!nearest || distance < nearest->distance)) {
            nearest = WallMeeting{distance, normal, finish, is_blades};
        }
    };
    for (const Ring* ring : {&front, &rear}) {
        const double inwards = ring == &front ? 1.0 : -1.0;
        if (d.z * inwards < 0.0) {
            const double distance = (ring->z - o.z) / d.z;
            const double r = std::hypot(o.x + distance * d.x, o.y + distance * d.y);
            if (r > ring->inner && r <= ring->outer) {
                take(distance, {0.0, 0.0, inwards}, ring->finish, ring->is_blades);
            }
        }
    }
    // The cone r = r₁ + m (z − z₁), where the ray leaves its inside: x² + y² − r² rises there.
    const double length = rear.z - front.z;
    if (length > 0.0) {
        const double m = (rear.outer - front.outer) / length;
        const double r = front.outer + m * (o.z - front.z);
        const double a = d.x * d.x + d.y * d.y - m * m * d.z * d.z;
        const double b = o.x * d.x + o.y * d.y - m * d.z * r;
        const double c = o.x * o.x + o.y * o.y - r * r;
        const double discriminant = b * b - a * c;
        if (discriminant > 0.0) {
            const double root = std::sqrt(discriminant);
            const double distance = b > 0.0 ? -c / (b + root) : (root - b) / a;
            const Vec3d at = o + distance * d;
            const double radius = front.outer + m * (at.z - front.z);
            if (at.z >= front.z && at.z <= rear.z && radius > 0.0) {
                take(distance, normalized(Vec3d{-at.x, -at.y, m * radius}), around, false);
            }
        }
    }
    return nearest;
}

}  // namespace lensproof::optics
