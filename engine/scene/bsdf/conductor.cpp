#include "engine/scene/bsdf/conductor.h"

#include <array>
#include <boost/math/quadrature/gauss.hpp>

#include "engine/scene/bsdf/directions.h"
#include "engine/scene/bsdf/fresnel.h"

namespace lensproof::scene {

namespace {

/// How often `sample` draws light that meets several facets: as much as single reflections lose.
double several_probability(const ConductorBsdf& bsdf, const Vec3d& wo) {
    return bsdf.losses != nullptr ? bsdf.losses->at(wo) : 0.0;
}

// For directions above the surface.

double pdf_above(const ConductorBsdf& bsdf, const Vec3d& wo, const Vec3d& wi, const GgxReflection& facets) {
    const double p_several = several_probability(bsdf, wo);
    return (1.0 - p_several) * facets.pdf + (p_several > 0.0 ? p_several * bsdf.losses->pdf(wi) : 0.0);
}

spectral::SpectralSample value_above(const ConductorBsdf& bsdf, const Vec3d& wo, const Vec3d& wi,
                                     const GgxReflection& facets) {
    spectral::SpectralSample value =
        static_cast<float>(facets.value) * conductor_reflectance(bsdf.n, bsdf.k, facets.cos_facet);
    const double lost = several_probability(bsdf, wo);
    if (lost > 0.0) {
        const double even = wi.z * std::numbers::inv_pi;
        value += static_cast<float>(lost * bsdf.losses->at(wi) / bsdf.losses->mean() * even) * bsdf.given_back;
    }
    return value;
}

bool is_possible(const ConductorBsdf& bsdf, const Vec3d& wo, const Vec3d& wi) {
    return !bsdf.roughness.is_smooth() && on_same_side(wo, wi);
}

}  // namespace

spectral::SpectralSample mean_conductor_reflectance(const spectral::SpectralSample& n,
                                                    const spectral::SpectralSample& k) {
    using Gauss = boost::math::quadrature::gauss<double, 20>;
    std::array<float, spectral::kWavelengthsPerPath> mean{};
    for (std::size_t i = 0; i < mean.size(); ++i) {
        const auto integrand = [&](double mu) { return 2.0 * mu * conductor_reflectance(n, k, mu)[i]; };
        mean[i] = static_cast<float>(Gauss::integrate(integrand, 0.0, 1.0));
    }
    return spectral::SpectralSample(mean);
}

spectral::SpectralSample evaluate(const ConductorBsdf& bsdf, const Vec3d& wo, const Vec3d& wi, Transport) {
    if (!is_possible(bsdf, wo, wi)) {
        return {};
    }
    const Vec3d from = upwards(wo);
    const Vec3d to = upwards(wi);
    return value_above(bsdf, from, to, ggx_reflection(bsdf.roughness, from, to));
}

double pdf(const ConductorBsdf& bsdf, const Vec3d& wo, const Vec3d& wi, Transport) {
    if (!is_possible(bsdf, wo, wi)) {
        return 0.0;
    }
    const Vec3d from = upwards(wo);
    const Vec3d to = upwards(wi);
    return pdf_above(bsdf, from, to, ggx_reflection(bsdf.roughness, from, to));
}

std::optional<BsdfSample> sample(const ConductorBsdf& bsdf, const Vec3d& wo, const BsdfNumbers& numbers, Transport) {
    if (wo.z == 0.0) {
        return std::nullopt;
    }
    if (bsdf.roughness.is_smooth()) {
        return BsdfSample{.wi = {-wo.x, -wo.y, wo.z},
                          .weight = conductor_reflectance(bsdf.n, bsdf.k, std::min(std::abs(wo.z), 1.0)),
                          .is_delta = true};
    }
    const Vec3d from = upwards(wo);
    const Vec3d wi = numbers.lobe < several_probability(bsdf, from)
                         ? bsdf.losses->sample(numbers.u1, numbers.u2)
                         : reflected(from, ggx_visible_normal(bsdf.roughness, from, numbers.u1, numbers.u2));
    if (!(wi.z > 0.0)) {
        return std::nullopt;
    }
    const GgxReflection facets = ggx_reflection(bsdf.roughness, from, wi);
    const double drawn_with = pdf_above(bsdf, from, wi, facets);
    return BsdfSample{.wi = on_side_of(wo, wi),
                      .weight = static_cast<float>(1.0 / drawn_with) * value_above(bsdf, from, wi, facets),
                      .pdf = drawn_with};
}

}  // namespace lensproof::scene
