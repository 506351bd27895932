#include "engine/optics/lens_bytes.h"

#include "engine/base/bytes.h"
#include "engine/optics/prescription.h"

namespace lensproof::optics {

namespace {

// Each struct is taken apart by all of its members' names at once: one that gets another member no longer compiles
// here.

void append_shape(std::string& bytes, const SurfaceShape<double>& shape) {
    const auto& [curvature, conic, asphere, terms, odd_asphere, odd_terms, along_normal, is_toroid, curvature_x] =
        shape;
    append_bytes(bytes, curvature, conic);
    if (along_normal) {
        append_bytes(bytes, -kAsphereTerms - 1);  // which is no count of odd terms
    }
    if (odd_terms > 0) {  // their count is negative, as that of the even ones never is
        append_bytes(bytes, -odd_terms);
        for (const double coefficient : odd_asphere) {
            append_bytes(bytes, coefficient);
        }
    }
    append_bytes(bytes, terms, is_toroid, curvature_x);
    for (const double coefficient : asphere) {
        append_bytes(bytes, coefficient);
    }
}

void append_coating(std::string& bytes, const TraceCoating<double>& coating) {
    const auto& [layers, reflectance, is_mirror] = coating;
    append_bytes(bytes, layers.size());
    for (const auto& [index, thickness, extinction] : layers) {
        append_bytes(bytes, index, thickness, extinction);
    }
    append_bytes(bytes, reflectance.has_value(), reflectance.value_or(0.0), is_mirror);
}

void append_special(std::string& bytes, const SpecialSurface<double>& special) {
    const auto& [has_shape, shape, vertex, axes, coating, mask, thin] = special;
    append_bytes(bytes, has_shape, vertex.x, vertex.y);
    append_shape(bytes, shape);
    for (const Vec3d& axis : axes) {
        append_bytes(bytes, axis.x, axis.y, axis.z);
    }
    append_coating(bytes, coating);
    mask.append_to(bytes);
    append_bytes(bytes, thin.kind, thin.power, thin.object_vergence, thin.linear);
    for (const double coefficient : thin.radial) {
        append_bytes(bytes, coefficient);
    }
}

}  // namespace

void append_lens_bytes(std::string& bytes, const TraceLens<double>& lens) {
    const auto& [surfaces, image_z, specials, attenuation] = lens;
    append_bytes(bytes, surfaces.size(), specials.size(), image_z, attenuation.size());
    for (const double per_mm : attenuation) {
        append_bytes(bytes, per_mm);
    }
    for (const TraceSurface<double>& surface : surfaces) {
        const auto& [curvature, vertex_z, semi_diameter_squared, index_before, index_after, forward_ratio,
                     reverse_ratio, is_stop, special, from_far_forward, from_far_reverse] = surface;
        append_bytes(bytes, curvature, vertex_z, semi_diameter_squared, index_before, index_after, forward_ratio,
                     reverse_ratio, is_stop, special, from_far_forward, from_far_reverse);
    }
    for (const SpecialSurface<double>& special : specials) {
        append_special(bytes, special);
    }
}

}  // namespace lensproof::optics
