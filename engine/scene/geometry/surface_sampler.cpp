#include "engine/scene/geometry/surface_sampler.h"

#include <algorithm>
#include <boost/math/special_functions/ellint_rg.hpp>
#include <cmath>

#include "engine/base/angle.h"
#include "engine/scene/geometry/geometry_data.h"
#include "engine/scene/geometry/packet/triangle_place.h"

namespace lensproof::scene {

namespace {

/// R_G is the symmetric elliptic integral (DLMF 19.33.1).
double ellipsoid_area(const Vec3d& semi_axes) {
    const double a = semi_axes.x * semi_axes.x;
    const double b = semi_axes.y * semi_axes.y;
    const double c = semi_axes.z * semi_axes.z;
    return 4.0 * kPi * boost::math::ellint_rg(a * b, a * c, b * c);
}

/// By how much the map stretches an area whose outward normal becomes the unit vector `world_normal`.
double area_stretch(const Matrix3& linear, const Vec3d& world_normal) {
    return std::abs(determinant(linear)) / length(transposed_times(linear, world_normal));
}

TrianglePlace<double> place_on_many_triangles(const std::vector<double>& areas_to, double sought, double u2) {
    const auto beyond = std::ranges::upper_bound(areas_to.begin() + 1, areas_to.end() - 1, sought);
    return place_on_triangle(areas_to.data(), static_cast<double>(beyond - (areas_to.begin() + 1)), sought, u2);
}

Vec3d sphere_direction(double u1, double u2) {
    const double z = 1.0 - 2.0 * u1;
    const double across = std::sqrt(std::max(0.0, 1.0 - z * z));
    return {across * std::cos(2.0 * kPi * u2), across * std::sin(2.0 * kPi * u2), z};
}

}  // namespace

SurfaceSampler::SurfaceSampler(const SceneGeometry& scene, std::uint32_t object) : scene_(&scene), object_(object) {
    const PlacedObject& placed = scene.data().objects[object];
    const Matrix3& m = placed.place.to_world.linear;
    if (const auto* sphere = std::get_if<Sphere>(placed.shape)) {
        area_mm2_ = ellipsoid_area(sphere->radius_mm * principal_stretches(m));
    } else if (const auto* quad = std::get_if<Quad>(placed.shape)) {
        area_mm2_ = quad->width_mm * quad->height_mm * length(cross(m * Vec3d{1, 0, 0}, m * Vec3d{0, 1, 0}));
    } else {
        const auto& mesh = std::get<TriangleMesh>(*placed.shape);
        areas_to_mm2_.push_back(0.0);
        for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
            const std::array<Vec3d, 3> p = corners(mesh, i);
            area_mm2_ += 0.5 * length(cross(m * (p[1] - p[0]), m * (p[2] - p[0])));
            areas_to_mm2_.push_back(area_mm2_);
        }
    }
    even_pdf_ = 1.0 / area_mm2_;
}

SurfaceSample SurfaceSampler::sample(double u1, double u2) const {
    const PlacedObject& placed = scene_->data().objects[object_];
    if (std::holds_alternative<Sphere>(*placed.shape)) {
        return drawn(world_hit(placed.place, shape_point(std::get<Sphere>(*placed.shape), sphere_direction(u1, u2),
                                                         placed.object.reads_uv)));
    }
    if (std::holds_alternative<Quad>(*placed.shape)) {
        return drawn(placed.facets.front(), u1, u2);
    }
    const double sought = u1 * area_mm2_;
    const std::size_t count = areas_to_mm2_.size() - 1;
    const auto [which, b1, b2] = count <= kFewTriangles
                                     ? place_on_few_triangles(areas_to_mm2_.data(), count, sought, u2)
                                     : place_on_many_triangles(areas_to_mm2_, sought, u2);
    const auto triangle = static_cast<std::uint32_t>(which);
    const auto& mesh = std::get<TriangleMesh>(*placed.shape);
    SurfaceSample sample = placed.facets.empty() ? drawn(world_hit(placed.place, shape_point(mesh, triangle, b1, b2)))
                                                 : drawn(placed.facets[triangle], b1, b2);
    sample.primitive = triangle;
    return sample;
}

std::span<const Facet> SurfaceSampler::facets() const {
    return scene_->data().objects[object_].facets;
}

SurfaceSample SurfaceSampler::drawn(const SurfaceHit& hit) const {
    return {.point = hit.point,
            .geometric_normal = hit.geometric_normal,
            .uv = hit.uv,
            .pdf_per_mm2 = pdf_per_mm2(hit),
            .error_mm = hit.error_mm};
}

SurfaceSample SurfaceSampler::drawn(const Facet& facet, double a, double b) const {
    return {.point = facet.point(a, b),
            .geometric_normal = facet.normal,
            .uv = facet.uv_at(a, b),
            .pdf_per_mm2 = even_pdf_,
            .error_mm = facet.error_mm};
}

double SurfaceSampler::pdf_per_mm2(const SurfaceHit& hit) const {
    const PlacedObject& placed = scene_->data().objects[object_];
    if (const auto* sphere = std::get_if<Sphere>(placed.shape)) {
        const double stretch = area_stretch(placed.place.to_world.linear, hit.geometric_normal);
        return 1.0 / (4.0 * kPi * sphere->radius_mm * sphere->radius_mm * stretch);
    }
    return even_pdf_;
}

}  // namespace lensproof::scene
