#include "engine/scene/bsdf/plastic.h"

#include "engine/scene/bsdf/directions.h"
#include "engine/scene/bsdf/fresnel.h"

namespace lensproof::scene {

namespace {

/// How often `sample` reflects at the coat: as much as that returns of all that comes back from `wo`.
double coat_probability(const PlasticBsdf& bsdf, double coat_reflectance) {
    return coat_reflectance / (coat_reflectance + (1.0 - coat_reflectance) * spectral::mean(bsdf.base));
}

/// The base's f |cos wi|.
spectral::SpectralSample base_value(const PlasticBsdf& bsdf, double reflectance_o, double mu_i) {
    const DielectricCoat& coat = *bsdf.coat;
    const double in_and_out = (1.0 - reflectance_o) * (1.0 - coat.reflectance(mu_i)) / (1.0 - coat.mean_reflectance());
    return static_cast<float>(in_and_out * mu_i * std::numbers::inv_pi) * bsdf.base;
}

/// f |cos wi| and the pdf for directions above the surface.
struct ScatteredBack {
    spectral::SpectralSample value;
    double pdf = 0.0;
};
ScatteredBack scattered(const PlasticBsdf& bsdf, const Vec3d& wo, const Vec3d& wi) {
    const DielectricCoat& coat = *bsdf.coat;
    const double reflectance_o = coat.reflectance(wo.z);
    const double p_coat = coat_probability(bsdf, reflectance_o);
    ScatteredBack result{.value = base_value(bsdf, reflectance_o, wi.z),
                         .pdf = (1.0 - p_coat) * wi.z * std::numbers::inv_pi};
    if (!bsdf.roughness.is_smooth()) {
        const GgxReflection facets = ggx_reflection(bsdf.roughness, wo, wi);
        const double reflectance = dielectric_reflectance(coat.eta(), facets.cos_facet);
        result.value += spectral::SpectralSample(static_cast<float>(facets.value * reflectance));
        result.pdf += p_coat * facets.pdf;
    }
    return result;
}

}  // namespace

PlasticBsdf plastic_bsdf(const spectral::SpectralSample& albedo, const DielectricCoat& coat) {
    const auto below = static_cast<float>(coat.mean_reflectance_below());
    // As albedo · (…) this way round it is exactly 1 where the albedo is.
    return {.base = spectral::for_each_wavelength(
                [&](float rho) { return rho * ((1.0F - below) / ((1.0F - below) + (1.0F - rho) * below)); }, albedo),
            .coat = &coat,
            .roughness = coat.roughness()};
}

spectral::SpectralSample evaluate(const PlasticBsdf& bsdf, const Vec3d& wo, const Vec3d& wi, Transport) {
    return on_same_side(wo, wi) ? scattered(bsdf, upwards(wo), upwards(wi)).value : spectral::SpectralSample();
}

double pdf(const PlasticBsdf& bsdf, const Vec3d& wo, const Vec3d& wi, Transport) {
    return on_same_side(wo, wi) ? scattered(bsdf, upwards(wo), upwards(wi)).pdf : 0.0;
}

std::optional<BsdfSample> sample(const PlasticBsdf& bsdf, const Vec3d& wo, const BsdfNumbers& numbers, Transport) {
    if (wo.z == 0.0) {
        return std::nullopt;
    }
    const Vec3d from = upwards(wo);
    const Roughness& roughness = bsdf.roughness;
    const double reflectance = bsdf.coat->reflectance(from.z);
    const double p_coat = coat_probability(bsdf, reflectance);
    const bool at_coat = numbers.lobe < p_coat;
    if (at_coat && roughness.is_smooth()) {
        return BsdfSample{.wi = {-wo.x, -wo.y, wo.z},
                          .weight = spectral::SpectralSample(static_cast<float>(reflectance / p_coat)),
                          .is_delta = true};
    }
    const Vec3d wi =
        at_coat ? reflected(from, ggx_visible_normal(roughness, from, numbers.u1, numbers.u2)) : numbers.matt;
    if (!(wi.z > 0.0)) {
        return std::nullopt;
    }
    const ScatteredBack outcome = scattered(bsdf, from, wi);
    return BsdfSample{
        .wi = on_side_of(wo, wi), .weight = static_cast<float>(1.0 / outcome.pdf) * outcome.value, .pdf = outcome.pdf};
}

}  // namespace lensproof::scene
