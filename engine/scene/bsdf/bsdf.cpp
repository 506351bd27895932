#include "engine/scene/bsdf/bsdf.h"

namespace lensproof {

SpectralSample evaluate(const Bsdf& bsdf, const Vec3d& wo, const Vec3d& wi, Transport transport) {
    return std::visit([&](const auto& model) { return evaluate(model, wo, wi, transport); }, bsdf);
}

double density(const Bsdf& bsdf, const Vec3d& wo, const Vec3d& wi, Transport transport) {
    return std::visit([&](const auto& model) { return density(model, wo, wi, transport); }, bsdf);
}

std::optional<BsdfSample> sample(const Bsdf& bsdf, const Vec3d& wo, double u_lobe, double u1, double u2,
                                 Transport transport) {
    return std::visit([&](const auto& model) { return sample(model, wo, u_lobe, u1, u2, transport); }, bsdf);
}

}  // namespace lensproof
