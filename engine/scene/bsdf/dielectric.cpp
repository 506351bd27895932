#include "engine/scene/bsdf/dielectric.h"

#include "engine/scene/bsdf/directions.h"
#include "engine/scene/bsdf/fresnel.h"

namespace lensproof {

namespace {

bool is_dispersive(const DielectricBsdf& bsdf) {
    return bsdf.eta != SpectralSample(bsdf.eta[0]);
}

/// How many of the wavelengths' indices differ, as far as it is worth knowing: they are computed one by one then.
std::size_t distinct_indices(const DielectricBsdf& bsdf) {
    return is_dispersive(bsdf) ? kWavelengthsPerPath : 1;
}

/// The index behind the boundary relative to that before it, for light that meets it from `wo`'s side.
double eta_behind(const DielectricBsdf& bsdf, const Vec3d& wo, std::size_t wavelength) {
    const double eta = bsdf.eta[wavelength];
    return wo.z > 0.0 ? eta : 1.0 / eta;
}

/// Applies `function` to each wavelength's index behind the boundary, or once where they are the same.
template <class Function>
SpectralSample for_each_index(const DielectricBsdf& bsdf, const Vec3d& wo, const Function& function) {
    const std::size_t count = distinct_indices(bsdf);
    SpectralSample result;
    for (std::size_t i = 0; i < count; ++i) {
        result[i] = static_cast<float>(function(eta_behind(bsdf, wo, i)));
    }
    return count == 1 ? SpectralSample(result[0]) : result;
}

/// The mean of `function` over the wavelengths' indices.
template <class Function>
double mean_over_indices(const DielectricBsdf& bsdf, const Vec3d& wo, const Function& function) {
    const std::size_t count = distinct_indices(bsdf);
    double sum = 0.0;
    for (std::size_t i = 0; i < count; ++i) {
        sum += function(eta_behind(bsdf, wo, i));
    }
    return sum / static_cast<double>(count);
}

/// What one facet refracts from wi, below the surface, to wo above it.
struct FacetRefraction {
    double value = 0.0;    // f |cos wi| for radiance (Walter et al. 2007, eq. 21)
    double density = 0.0;  // of wi, as ggx_visible_normal draws facets and the facet's Fresnel transmittance passes
};

FacetRefraction facet_refraction(const Roughness& roughness, const Vec3d& wo, const Vec3d& wi, double eta) {
    const Vec3d across = wo + eta * wi;  // along the facet's normal (eq. 16)
    const double size = length(across);
    if (!(size > 0.0)) {
        return {};
    }
    const Vec3d m = std::copysign(1.0 / size, across.z) * across;
    const double cos_o = dot(wo, m);
    const double cos_i = -dot(wi, m);
    if (!(cos_o > 0.0 && cos_i > 0.0)) {
        return {};
    }
    const double passing = 1.0 - dielectric_reflectance(eta, std::min(cos_o, 1.0));
    const double seen = passing * ggx_facets(roughness, m) * ggx_visible_per_cos(roughness, wo) * cos_o * cos_i /
                        (size * size);  // size = |wo·m + η wi·m|
    return {.value = seen * ggx_visible_per_cos(roughness, upwards(wi)) * -wi.z, .density = seen * eta * eta};
}

/// What refraction does to the light that passes: radiance spreads out by 1 / η², importance stays.
float transmission_scale(double eta, Transport transport) {
    return transport == Transport::radiance ? static_cast<float>(1.0 / (eta * eta)) : 1.0F;
}

/// The direction behind a boundary of normal m (wo·m > 0) under which `wo` continues; nothing in total reflection.
std::optional<Vec3d> refracted(const Vec3d& wo, const Vec3d& m, double cos_incidence, double eta) {
    const auto outcome = refract(-1.0 * wo, -1.0 * m, cos_incidence, 1.0 / eta);
    return outcome.transmitted ? std::optional(outcome.direction) : std::nullopt;
}

std::optional<BsdfSample> sample_smooth(const DielectricBsdf& bsdf, const Vec3d& wo, double u_lobe,
                                        Transport transport) {
    const Vec3d from = upwards(wo);
    const double cos_incidence = std::min(from.z, 1.0);
    const double hero_reflectance = dielectric_reflectance(eta_behind(bsdf, wo, 0), cos_incidence);
    if (u_lobe < hero_reflectance) {
        const SpectralSample reflectance =
            for_each_index(bsdf, wo, [&](double eta) { return dielectric_reflectance(eta, cos_incidence); });
        return BsdfSample{.wi = {-wo.x, -wo.y, wo.z},
                          .weight = reflectance / SpectralSample(static_cast<float>(hero_reflectance)),
                          .is_delta = true};
    }
    const double eta = eta_behind(bsdf, wo, 0);
    const std::optional<Vec3d> down = refracted(from, {0.0, 0.0, 1.0}, cos_incidence, eta);
    if (!down || down->z == 0.0) {
        return std::nullopt;
    }
    const SpectralSample weight(transmission_scale(eta, transport));
    return BsdfSample{.wi = wo.z > 0.0 ? *down : Vec3d{down->x, down->y, -down->z},
                      .weight = is_dispersive(bsdf) ? hero_alone(weight) : weight,
                      .is_delta = true,
                      .is_dispersed = is_dispersive(bsdf)};
}

/// Draws a direction from one of the wavelengths.
std::optional<Vec3d> rough_direction(const DielectricBsdf& bsdf, const Vec3d& wo, double u_lobe, double u1, double u2) {
    const std::size_t count = distinct_indices(bsdf);
    const double scaled = u_lobe * static_cast<double>(count);
    const std::size_t drawn = std::min(static_cast<std::size_t>(scaled), count - 1);
    const double u_pass = scaled - static_cast<double>(drawn);
    const double eta = eta_behind(bsdf, wo, drawn);
    const Vec3d from = upwards(wo);
    const Vec3d m = ggx_visible_normal(bsdf.roughness, from, u1, u2);
    const double cos_facet = std::min(dot(from, m), 1.0);
    if (u_pass < dielectric_reflectance(eta, cos_facet)) {
        const Vec3d wi = reflected(from, m);
        return wi.z > 0.0 ? std::optional(on_side_of(wo, wi)) : std::nullopt;
    }
    const std::optional<Vec3d> down = refracted(from, m, cos_facet, eta);
    if (!down || !(down->z < 0.0)) {
        return std::nullopt;
    }
    return wo.z > 0.0 ? *down : Vec3d{down->x, down->y, -down->z};
}

}  // namespace

bool is_delta(const DielectricBsdf& bsdf) {
    return bsdf.roughness.is_smooth() || bsdf.eta == SpectralSample(1.0F);
}

SpectralSample evaluate(const DielectricBsdf& bsdf, const Vec3d& wo, const Vec3d& wi, Transport transport) {
    if (is_delta(bsdf) || wo.z == 0.0 || wi.z == 0.0) {
        return {};
    }
    const Vec3d from = upwards(wo);
    if (on_same_side(wo, wi)) {
        const GgxReflection facets = ggx_reflection(bsdf.roughness, from, upwards(wi));
        return for_each_index(bsdf, wo,
                              [&](double eta) { return facets.value * dielectric_reflectance(eta, facets.cos_facet); });
    }
    const Vec3d to{wi.x, wi.y, -std::abs(wi.z)};
    return for_each_index(bsdf, wo, [&](double eta) {
        // Importance, which refraction does not spread, is scattered by η² times as much.
        const double adjoint = transport == Transport::radiance ? 1.0 : eta * eta;
        return adjoint * facet_refraction(bsdf.roughness, from, to, eta).value;
    });
}

double density(const DielectricBsdf& bsdf, const Vec3d& wo, const Vec3d& wi, Transport) {
    if (is_delta(bsdf) || wo.z == 0.0 || wi.z == 0.0) {
        return 0.0;
    }
    const Vec3d from = upwards(wo);
    if (on_same_side(wo, wi)) {
        const GgxReflection facets = ggx_reflection(bsdf.roughness, from, upwards(wi));
        return facets.density *
               mean_over_indices(bsdf, wo, [&](double eta) { return dielectric_reflectance(eta, facets.cos_facet); });
    }
    const Vec3d to{wi.x, wi.y, -std::abs(wi.z)};
    return mean_over_indices(bsdf, wo,
                             [&](double eta) { return facet_refraction(bsdf.roughness, from, to, eta).density; });
}

std::optional<BsdfSample> sample(const DielectricBsdf& bsdf, const Vec3d& wo, double u_lobe, double u1, double u2,
                                 Transport transport) {
    if (wo.z == 0.0) {
        return std::nullopt;
    }
    if (is_delta(bsdf)) {
        return sample_smooth(bsdf, wo, u_lobe, transport);
    }
    const std::optional<Vec3d> wi = rough_direction(bsdf, wo, u_lobe, u1, u2);
    if (!wi) {
        return std::nullopt;
    }
    const double drawn_with = density(bsdf, wo, *wi, transport);
    if (!(drawn_with > 0.0)) {
        return std::nullopt;
    }
    return BsdfSample{.wi = *wi,
                      .weight = static_cast<float>(1.0 / drawn_with) * evaluate(bsdf, wo, *wi, transport),
                      .density = drawn_with};
}

}  // namespace lensproof
