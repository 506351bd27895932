#include "engine/scene/bsdf/conductor.h"

#include "engine/scene/bsdf/directions.h"
#include "engine/scene/bsdf/fresnel.h"

namespace lensproof {

SpectralSample evaluate(const ConductorBsdf& bsdf, const Vec3d& wo, const Vec3d& wi, Transport) {
    if (bsdf.roughness.is_smooth() || !on_same_side(wo, wi)) {
        return {};
    }
    const GgxReflection facets = ggx_reflection(bsdf.roughness, upwards(wo), upwards(wi));
    return static_cast<float>(facets.value) * conductor_reflectance(bsdf.n, bsdf.k, facets.cos_facet);
}

double density(const ConductorBsdf& bsdf, const Vec3d& wo, const Vec3d& wi, Transport) {
    if (bsdf.roughness.is_smooth() || !on_same_side(wo, wi)) {
        return 0.0;
    }
    return ggx_reflection(bsdf.roughness, upwards(wo), upwards(wi)).density;
}

std::optional<BsdfSample> sample(const ConductorBsdf& bsdf, const Vec3d& wo, double, double u1, double u2, Transport) {
    if (wo.z == 0.0) {
        return std::nullopt;
    }
    if (bsdf.roughness.is_smooth()) {
        return BsdfSample{.wi = {-wo.x, -wo.y, wo.z},
                          .weight = conductor_reflectance(bsdf.n, bsdf.k, std::abs(wo.z)),
                          .is_delta = true};
    }
    const Vec3d from = upwards(wo);
    const Vec3d m = ggx_visible_normal(bsdf.roughness, from, u1, u2);
    const Vec3d wi = reflected(from, m);
    if (!(wi.z > 0.0)) {
        return std::nullopt;
    }
    const auto unmasked = static_cast<float>(ggx_reflection_weight(bsdf.roughness, from, wi));
    return BsdfSample{.wi = on_side_of(wo, wi),
                      .weight = unmasked * conductor_reflectance(bsdf.n, bsdf.k, std::min(dot(from, m), 1.0)),
                      .density = ggx_reflection(bsdf.roughness, from, wi).density};
}

}  // namespace lensproof
