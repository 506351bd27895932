#include "engine/scene/bsdf/diffuse.h"

#include "engine/scene/bsdf/directions.h"

namespace lensproof::scene {

spectral::SpectralSample evaluate(const DiffuseBsdf& bsdf, const Vec3d& wo, const Vec3d& wi, Transport transport) {
    return static_cast<float>(pdf(bsdf, wo, wi, transport)) * bsdf.albedo;
}

double pdf(const DiffuseBsdf&, const Vec3d& wo, const Vec3d& wi, Transport) {
    return on_same_side(wo, wi) ? std::abs(wi.z) * std::numbers::inv_pi : 0.0;
}

std::optional<BsdfSample> sample(const DiffuseBsdf& bsdf, const Vec3d& wo, const BsdfNumbers& numbers, Transport) {
    if (wo.z == 0.0 || numbers.matt.z == 0.0) {
        return std::nullopt;
    }
    return BsdfSample{
        .wi = on_side_of(wo, numbers.matt), .weight = bsdf.albedo, .pdf = numbers.matt.z * std::numbers::inv_pi};
}

}  // namespace lensproof::scene
