#include "engine/scene/bsdf/dielectric.h"

#include <array>

#include "engine/scene/bsdf/directions.h"
#include "engine/scene/bsdf/fresnel.h"

namespace lensproof::scene {

namespace {

bool is_dispersive(const DielectricBsdf& bsdf) {
    return bsdf.eta != spectral::SpectralSample(bsdf.eta[0]);
}

/// How many of the wavelengths' indices differ, as far as it is worth knowing: they are computed one by one then.
std::size_t distinct_indices(const DielectricBsdf& bsdf) {
    return is_dispersive(bsdf) ? spectral::kWavelengthsPerPath : 1;
}

/// The index behind the boundary relative to that before it, for light that meets it from `wo`'s side.
double eta_behind(const DielectricBsdf& bsdf, const Vec3d& wo, std::size_t wavelength) {
    const double eta = bsdf.eta[wavelength];
    return wo.z > 0.0 ? eta : 1.0 / eta;
}

/// Applies `function` to each wavelength's index behind the boundary, or once where they are the same.
template <class Function>
spectral::SpectralSample for_each_index(const DielectricBsdf& bsdf, const Vec3d& wo, const Function& function) {
    const std::size_t count = distinct_indices(bsdf);
    std::array<float, spectral::kWavelengthsPerPath> result{};
    for (std::size_t i = 0; i < count; ++i) {
        result[i] = static_cast<float>(function(eta_behind(bsdf, wo, i)));
    }
    return count == 1 ? spectral::SpectralSample(result[0]) : spectral::SpectralSample(result);
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

/// At one index: f |cos wi| for radiance, and the pdf of wi where it is drawn for that index.
struct ThroughFacets {
    double value = 0.0;
    double pdf = 0.0;
};

/// What facets refract from wi, below the surface, to wo above it (Walter et al. 2007, eq. 21).
ThroughFacets facet_refraction(const Roughness& roughness, const Vec3d& wo, const Vec3d& wi, double eta) {
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
    return {.value = seen * ggx_visible_per_cos(roughness, upwards(wi)) * -wi.z, .pdf = seen * eta * eta};
}

/// What leaves on the other side of the light that meets several facets. With L and L' the two sides' mean losses and η
/// the index beyond, f is reciprocal where the fractions that pass are as η² L' to L; the ones that add up to 1 are
/// these.
double transmitted_fraction(const BoundaryLosses::Loss& lost, double eta) {
    const double beyond = eta * eta * lost.mean_beyond;
    return beyond > 0.0 ? beyond / (lost.mean + beyond) : 0.0;
}

/// A rough boundary and a pair of directions.
class RoughPair {
  public:
    RoughPair(const DielectricBsdf& bsdf, const Vec3d& wo, const Vec3d& wi)
        : bsdf_(bsdf), wo_(wo), wi_(wi), is_reflection_(on_same_side(wo, wi)) {
        if (is_reflection_) {
            reflection_ = ggx_reflection(bsdf.roughness, upwards(wo), upwards(wi));
        }
    }

    [[nodiscard]] bool is_reflection() const { return is_reflection_; }

    /// `eta`: the index behind the boundary.
    [[nodiscard]] ThroughFacets at(double eta) const {
        ThroughFacets once = by_one_facet(eta);
        return bsdf_.losses == nullptr ? once : with_several_facets(once, eta);
    }

  private:
    [[nodiscard]] ThroughFacets by_one_facet(double eta) const {
        if (is_reflection_) {
            const double reflectance = dielectric_reflectance(eta, reflection_.cos_facet);
            return {.value = reflection_.value * reflectance, .pdf = reflection_.pdf * reflectance};
        }
        return facet_refraction(bsdf_.roughness, upwards(wo_), {wi_.x, wi_.y, -std::abs(wi_.z)}, eta);
    }

    [[nodiscard]] ThroughFacets with_several_facets(const ThroughFacets& once, double eta) const {
        const double eta_below = wo_.z > 0.0 ? eta : 1.0 / eta;
        const BoundaryLosses::Loss lost = bsdf_.losses->of(wo_, eta_below);
        const BoundaryLosses::Loss at_wi = bsdf_.losses->of(wi_, eta_below);
        const double passing = transmitted_fraction(lost, eta);
        const double fraction = is_reflection_ ? 1.0 - passing : passing;
        const double several = lost.at_direction * fraction;
        const double returned =
            at_wi.mean > 0.0 ? several * at_wi.at_direction / at_wi.mean * std::abs(wi_.z) * std::numbers::inv_pi : 0.0;
        const double drawn = bsdf_.losses->nearest(wi_.z > 0.0, eta_below).pdf(upwards(wi_));
        return {.value = once.value + (is_reflection_ ? returned : returned / (eta * eta)),
                .pdf = (1.0 - lost.at_direction) * once.pdf + several * drawn};
    }

    const DielectricBsdf& bsdf_;
    Vec3d wo_;
    Vec3d wi_;
    bool is_reflection_;
    GgxReflection reflection_;
};

/// What refraction does to the light that passes: radiance spreads out by 1 / η², importance stays.
float transmission_scale(double eta, Transport transport) {
    return transport == Transport::radiance ? static_cast<float>(1.0 / (eta * eta)) : 1.0F;
}

/// The direction behind a boundary of normal m (wo·m > 0) under which `wo` continues; nothing in total reflection.
std::optional<Vec3d> refracted(const Vec3d& wo, const Vec3d& m, double cos_incidence, double eta) {
    const auto outcome = optics::refract(-1.0 * wo, -1.0 * m, cos_incidence, 1.0 / eta);
    return outcome.transmitted ? std::optional(outcome.direction) : std::nullopt;
}

std::optional<BsdfSample> sample_smooth(const DielectricBsdf& bsdf, const Vec3d& wo, double u_lobe,
                                        Transport transport) {
    const Vec3d from = upwards(wo);
    const double cos_incidence = std::min(from.z, 1.0);
    const double hero_reflectance = dielectric_reflectance(eta_behind(bsdf, wo, 0), cos_incidence);
    if (u_lobe < hero_reflectance) {
        const spectral::SpectralSample reflectance =
            for_each_index(bsdf, wo, [&](double eta) { return dielectric_reflectance(eta, cos_incidence); });
        return BsdfSample{.wi = {-wo.x, -wo.y, wo.z},
                          .weight = reflectance / spectral::SpectralSample(static_cast<float>(hero_reflectance)),
                          .is_delta = true};
    }
    const double eta = eta_behind(bsdf, wo, 0);
    const std::optional<Vec3d> down = refracted(from, {0.0, 0.0, 1.0}, cos_incidence, eta);
    if (!down || down->z == 0.0) {
        return std::nullopt;
    }
    const spectral::SpectralSample weight = transmission_scale(eta, transport) * bsdf.tint;
    return BsdfSample{.wi = wo.z > 0.0 ? *down : Vec3d{down->x, down->y, -down->z},
                      .weight = is_dispersive(bsdf) ? spectral::hero_alone(weight) : weight,
                      .is_delta = true,
                      .is_dispersed = is_dispersive(bsdf)};
}

/// Draws a direction below or above the boundary for light that meets several facets.
Vec3d direction_after_several(const DielectricBsdf& bsdf, const Vec3d& wo, double eta, double u_pass, double u1,
                              double u2) {
    const double eta_below = wo.z > 0.0 ? eta : 1.0 / eta;
    const bool passes = u_pass < transmitted_fraction(bsdf.losses->of(wo, eta_below), eta);
    const bool is_above = (wo.z > 0.0) != passes;
    const Vec3d upward = bsdf.losses->nearest(is_above, eta_below).sample(u1, u2);
    return {upward.x, upward.y, is_above ? upward.z : -upward.z};
}

/// Draws a direction for one index; nothing where the facet sends light to others.
std::optional<Vec3d> direction_after_one(const DielectricBsdf& bsdf, const Vec3d& wo, double eta, double u_pass,
                                         double u1, double u2) {
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

/// Draws a direction for one of the wavelengths, each as often.
std::optional<Vec3d> rough_direction(const DielectricBsdf& bsdf, const Vec3d& wo, const BsdfNumbers& numbers) {
    const std::size_t count = distinct_indices(bsdf);
    const double scaled = numbers.lobe * static_cast<double>(count);
    const std::size_t drawn = std::min(static_cast<std::size_t>(scaled), count - 1);
    const double u = scaled - static_cast<double>(drawn);
    const double eta = eta_behind(bsdf, wo, drawn);
    const double several =
        bsdf.losses == nullptr ? 0.0 : bsdf.losses->of(wo, wo.z > 0.0 ? eta : 1.0 / eta).at_direction;
    return u < several ? std::optional(direction_after_several(bsdf, wo, eta, u / several, numbers.u1, numbers.u2))
                       : direction_after_one(bsdf, wo, eta, (u - several) / (1.0 - several), numbers.u1, numbers.u2);
}

}  // namespace

bool is_delta(const DielectricBsdf& bsdf) {
    return bsdf.roughness.is_smooth() || bsdf.eta == spectral::SpectralSample(1.0F);
}

spectral::SpectralSample evaluate(const DielectricBsdf& bsdf, const Vec3d& wo, const Vec3d& wi, Transport transport) {
    if (is_delta(bsdf) || wo.z == 0.0 || wi.z == 0.0) {
        return {};
    }
    const RoughPair pair(bsdf, wo, wi);
    // Importance, which refraction does not spread, passes η² times as much.
    const bool spreads = transport == Transport::radiance || pair.is_reflection();
    const spectral::SpectralSample value =
        for_each_index(bsdf, wo, [&](double eta) { return pair.at(eta).value * (spreads ? 1.0 : eta * eta); });
    return pair.is_reflection() ? value : value * bsdf.tint;
}

double pdf(const DielectricBsdf& bsdf, const Vec3d& wo, const Vec3d& wi, Transport) {
    if (is_delta(bsdf) || wo.z == 0.0 || wi.z == 0.0) {
        return 0.0;
    }
    const RoughPair pair(bsdf, wo, wi);
    return mean_over_indices(bsdf, wo, [&](double eta) { return pair.at(eta).pdf; });
}

std::optional<BsdfSample> sample(const DielectricBsdf& bsdf, const Vec3d& wo, const BsdfNumbers& numbers,
                                 Transport transport) {
    if (wo.z == 0.0) {
        return std::nullopt;
    }
    if (is_delta(bsdf)) {
        return sample_smooth(bsdf, wo, numbers.lobe, transport);
    }
    const std::optional<Vec3d> wi = rough_direction(bsdf, wo, numbers);
    if (!wi) {
        return std::nullopt;
    }
    const double drawn_with = pdf(bsdf, wo, *wi, transport);
    if (!(drawn_with > 0.0)) {
        return std::nullopt;
    }
    return BsdfSample{.wi = *wi,
                      .weight = static_cast<float>(1.0 / drawn_with) * evaluate(bsdf, wo, *wi, transport),
                      .pdf = drawn_with};
}

spectral::SpectralSample pane_reflectance(const PaneBsdf& pane, double cos_incidence) {
    return spectral::for_each_wavelength(
        [&](float eta) {
            const double reflectance = dielectric_reflectance(eta, std::min(cos_incidence, 1.0));
            return static_cast<float>(2.0 * reflectance / (1.0 + reflectance));
        },
        pane.eta);
}

spectral::SpectralSample evaluate(const PaneBsdf&, const Vec3d&, const Vec3d&, Transport) {
    return {};
}

double pdf(const PaneBsdf&, const Vec3d&, const Vec3d&, Transport) {
    return 0.0;
}

std::optional<BsdfSample> sample(const PaneBsdf& bsdf, const Vec3d& wo, const BsdfNumbers& numbers, Transport) {
    if (wo.z == 0.0) {
        return std::nullopt;
    }
    const spectral::SpectralSample reflectance = pane_reflectance(bsdf, std::abs(wo.z));
    const float hero = reflectance[0];
    if (numbers.lobe < hero) {
        return BsdfSample{.wi = {-wo.x, -wo.y, wo.z}, .weight = (1.0F / hero) * reflectance, .is_delta = true};
    }
    return BsdfSample{.wi = -1.0 * wo,
                      .weight = (1.0F / (1.0F - hero)) * (spectral::SpectralSample(1.0F) - reflectance) * bsdf.tint,
                      .is_delta = true};
}

}  // namespace lensproof::scene
