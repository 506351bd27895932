#include "engine/analysis/spot.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace lensproof::analysis {

namespace {

/// Nothing for a ray that leaves the lens away from the sensor.
std::optional<SpotRay> at_image(const optics::TraceLens<double>& lens, const optics::TracedRay<double>& traced,
                                double weight) {
    const Vec3d& direction = traced.ray.direction;
    if (!(direction.z > 0.0)) {
        return std::nullopt;
    }
    const Vec3d point = optics::meet_plane(traced.ray, lens.image_z).point;
    return SpotRay{{point.x, point.y}, {direction.x / direction.z, direction.y / direction.z}, weight};
}

struct Means {
    double weight = 0.0;
    Vec2d point{};
    Vec2d slope{};
};

Means means(std::span<const SpotRay> rays) {
    Means sum;
    for (const SpotRay& ray : rays) {
        sum.weight += ray.weight;
        sum.point = sum.point + ray.weight * ray.point;
        sum.slope = sum.slope + ray.weight * ray.slope;
    }
    if (sum.weight > 0.0) {
        sum.point = sum.point / sum.weight;
        sum.slope = sum.slope / sum.weight;
    }
    return sum;
}

}  // namespace

std::vector<SpotRay> spot_rays(const optics::TraceLens<double>& lens, const optics::FieldBundle& bundle,
                               const optics::RegionOutline& outline, int rings) {
    std::vector<SpotRay> rays;
    const auto add = [&](Vec2d offset, double weight, bool is_mirrored) {
        // A ray on the outline is inside to a rounding; it is followed all the same.
        const optics::TracedRay<double> traced =
            weight > 0.0 ? optics::trace(lens, bundle.ray(offset)) : optics::trace_past_rims(lens, bundle.ray(offset));
        const bool arrives =
            weight > 0.0 ? traced.status == optics::RayStatus::ok : optics::gets_through(traced.status);
        const std::optional<SpotRay> ray = arrives ? at_image(lens, traced, weight) : std::nullopt;
        if (!ray) {
            return;
        }
        rays.push_back(*ray);
        if (is_mirrored) {
            rays.push_back({{-ray->point.x, ray->point.y}, {-ray->slope.x, ray->slope.y}, ray->weight});
        }
    };
    const optics::GaussRule rule = optics::gauss_legendre(rings);
    for (const optics::OutlinePoint& point : outline.points) {
        for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
            add(outline.at(point, rule.nodes[i]), 2.0 * rule.nodes[i] * rule.weights[i] * point.wedge_area,
                outline.is_half);
        }
        add(outline.at(point, 1.0), 0.0, outline.is_half);
    }
    return rays;
}

std::vector<SpotRay> spot_grid(const optics::TraceLens<double>& lens, const optics::FieldBundle& bundle,
                               double half_width, int cells) {
    std::vector<SpotRay> rays;
    const double cell = 2.0 * half_width / cells;
    for (int i = 0; i < cells; ++i) {
        for (int k = 0; k < cells; ++k) {
            const Vec2d offset{half_width * (2 * i + 1 - cells) / cells, half_width * (2 * k + 1 - cells) / cells};
            const optics::TracedRay<double> traced = optics::trace(lens, bundle.ray(offset));
            if (traced.status != optics::RayStatus::ok) {
                continue;
            }
            if (const std::optional<SpotRay> ray = at_image(lens, traced, cell * cell)) {
                rays.push_back(*ray);
            }
        }
    }
    return rays;
}

std::vector<SpotRay> pooled(std::span<const std::vector<SpotRay>> spots, std::span<const double> spectral_weights) {
    std::vector<SpotRay> all;
    for (std::size_t i = 0; i < spots.size(); ++i) {
        for (SpotRay ray : spots[i]) {
            ray.weight *= spectral_weights[i];
            all.push_back(ray);
        }
    }
    return all;
}

SpotSize spot_size(std::span<const SpotRay> rays, double defocus_mm) {
    const Means mean = means(rays);
    if (!(mean.weight > 0.0)) {
        return {};
    }
    SpotSize size;
    size.centroid = mean.point + defocus_mm * mean.slope;
    double sum = 0.0;
    double largest = 0.0;
    for (const SpotRay& ray : rays) {
        const Vec2d off = ray.at(defocus_mm) - size.centroid;
        sum += ray.weight * dot(off, off);
        largest = std::max(largest, dot(off, off));
    }
    size.rms = std::sqrt(sum / mean.weight);
    size.max_radius = std::sqrt(largest);
    return size;
}

}  // namespace lensproof::analysis
