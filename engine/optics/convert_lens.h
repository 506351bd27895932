// engine/optics/convert_lens.h — the same lens and the same ray in another number type.
#pragma once
#include <algorithm>
#include <cmath>
#include <iterator>

#include "engine/optics/trace.h"

namespace lensproof::optics {

template <class To, class From>
Vec3<To> convert_vector(const Vec3<From>& v) {
    return {static_cast<To>(v.x), static_cast<To>(v.y), static_cast<To>(v.z)};
}

/// The ray with its direction normalised in To: a double's unit vector is not one to a multiprecision number's last
/// digits.
template <class To, class From>
Ray<To> convert_ray(const Ray<From>& ray) {
    return {convert_vector<To>(ray.origin), normalized(convert_vector<To>(ray.direction))};
}

template <class To, class From>
SpecialSurface<To> convert_special(const SpecialSurface<From>& from) {
    SpecialSurface<To> to;
    to.has_shape = from.has_shape;
    to.shape = {.curvature = static_cast<To>(from.shape.curvature),
                .conic = static_cast<To>(from.shape.conic),
                .terms = from.shape.terms,
                .odd_terms = from.shape.odd_terms,
                .along_normal = from.shape.along_normal,
                .is_toroid = from.shape.is_toroid,
                .curvature_x = static_cast<To>(from.shape.curvature_x)};
    const auto convert_term = [](const From& term) { return static_cast<To>(term); };
    std::ranges::transform(from.shape.asphere, to.shape.asphere.begin(), convert_term);
    std::ranges::transform(from.shape.odd_asphere, to.shape.odd_asphere.begin(), convert_term);
    to.vertex = {static_cast<To>(from.vertex.x), static_cast<To>(from.vertex.y)};
    std::ranges::transform(from.axes, to.axes.begin(), convert_vector<To, From>);
    for (const auto& layer : from.coating.layers) {
        to.coating.layers.push_back(
            {static_cast<To>(layer.index), static_cast<To>(layer.thickness), static_cast<To>(layer.extinction)});
    }
    if (from.coating.reflectance) {
        to.coating.reflectance = static_cast<To>(*from.coating.reflectance);
    }
    to.coating.is_mirror = from.coating.is_mirror;
    to.mask = from.mask;
    to.thin = {.kind = from.thin.kind,
               .power = static_cast<To>(from.thin.power),
               .object_vergence = static_cast<To>(from.thin.object_vergence),
               .linear = static_cast<To>(from.thin.linear)};
    std::ranges::transform(from.thin.radial, to.thin.radial.begin(), convert_term);
    return to;
}

/// `lens` with exactly its numbers, each rounded to To where To is shorter; what follows from them (ratios of indices,
/// squares of semi-diameters) is formed in To. A semi-diameter is the root of its square: √(fl(a²)) rounds back to a.
template <class To, class From>
TraceLens<To> convert_lens(const TraceLens<From>& lens) {
    using std::sqrt;
    TraceLens<To> converted{.surfaces = {}, .image_z = static_cast<To>(lens.image_z)};
    for (const TraceSurface<From>& surface : lens.surfaces) {
        const From semi_diameter = sqrt(surface.semi_diameter_squared);
        converted.surfaces.push_back(make_trace_surface<To>(
            static_cast<To>(surface.curvature), static_cast<To>(surface.vertex_z), static_cast<To>(semi_diameter),
            static_cast<To>(surface.index_before), static_cast<To>(surface.index_after), surface.is_stop));
        converted.surfaces.back().special = surface.special;
        converted.surfaces.back().from_far_forward = surface.from_far_forward;
        converted.surfaces.back().from_far_reverse = surface.from_far_reverse;
    }
    std::ranges::transform(lens.specials, std::back_inserter(converted.specials), convert_special<To, From>);
    std::ranges::transform(lens.attenuation, std::back_inserter(converted.attenuation),
                           [](const From& attenuation) { return static_cast<To>(attenuation); });
    return converted;
}

}  // namespace lensproof::optics
