#include "engine/scene/material/metallic_material.h"

#include <algorithm>
#include <cmath>

namespace lensproof::scene {

namespace {

constexpr double kFinest = 1.0 / 64.0;
constexpr double kBrightest = 0.9999;  // a metal that reflects all has no index
constexpr std::size_t kMetalSteps = 64;

float metal_k(float reflectance) {
    const float rho = std::clamp(reflectance, 0.0F, static_cast<float>(kBrightest));
    return 2.0F * std::sqrt(rho / (1.0F - rho));
}

/// Between the steps of `metal_means`.
float mean_reflectance(const std::vector<float>& means, float rho) {
    const float place = std::clamp(rho, 0.0F, 1.0F) * kMetalSteps;
    const std::size_t step = std::min(static_cast<std::size_t>(place), kMetalSteps - 1);
    return means[step] + (place - static_cast<float>(step)) * (means[step + 1] - means[step]);
}

ConductorBsdf metal(const MetallicMaterial& material, const spectral::SpectralSample& base,
                    const Roughness& roughness) {
    ConductorBsdf metal{.n = spectral::SpectralSample(1.0F),
                        .k = spectral::for_each_wavelength(metal_k, base),
                        .roughness = roughness,
                        .losses = roughness.is_smooth() ? nullptr : material.facets->mirrors(roughness.alpha_x)};
    if (metal.losses != nullptr) {
        metal.given_back = spectral::for_each_wavelength(
            [&](float rho) {
                return static_cast<float>(
                    given_back(mean_reflectance(material.metal_means, rho), metal.losses->mean()));
            },
            base);
    }
    return metal;
}

PlasticBsdf plastic(const MetallicMaterial& material, const spectral::SpectralSample& base,
                    const Roughness& roughness) {
    PlasticBsdf plastic = plastic_bsdf(base, *material.facets->coat(roughness.alpha_x));
    plastic.roughness = roughness;
    return plastic;
}

SimpleBsdf glass(const MetallicMaterial& material, const spectral::SpectralSample& base, const Roughness& roughness) {
    const spectral::SpectralSample eta(static_cast<float>(material.eta));
    if (!material.is_body) {
        return PaneBsdf{.eta = eta, .tint = base};
    }
    return DielectricBsdf{.eta = eta,
                          .roughness = roughness,
                          .losses = roughness.is_smooth() ? nullptr : material.facets->glass(roughness.alpha_x),
                          .tint = spectral::for_each_wavelength([](float rho) { return std::sqrt(rho); }, base)};
}

}  // namespace

FacetSteps::FacetSteps(double eta, double least, double most, const Wanted& wanted)
    : first_(kFinest * std::round(least / kFinest)) {
    std::size_t steps = 1;
    if (least == most) {
        first_ = least;
    } else {
        spacing_ = kFinest;
        steps = static_cast<std::size_t>(std::round(most / kFinest) - std::round(least / kFinest)) + 1;
    }
    for (std::size_t i = 0; i < steps; ++i) {
        const double alpha = first_ + static_cast<double>(i) * spacing_;
        const Roughness roughness = resolvable({.alpha_x = alpha, .alpha_y = alpha});
        if (wanted.is_metal) {
            mirrors_.push_back(roughness.is_smooth() ? std::nullopt
                                                     : std::optional(FacetLosses::of_mirrors(roughness)));
        }
        if (wanted.is_plastic) {
            coats_.emplace_back(std::in_place, eta, alpha);
        }
        if (wanted.is_glass) {
            glass_.push_back(roughness.is_smooth() ? std::nullopt : std::optional(BoundaryLosses(roughness, eta, eta)));
        }
    }
}

std::size_t FacetSteps::step_of(double alpha) const {
    if (spacing_ == 0.0) {
        return 0;
    }
    const std::size_t count = std::max({mirrors_.size(), coats_.size(), glass_.size()});
    return std::min(static_cast<std::size_t>(std::max(0.0, (alpha - first_) / spacing_ + 0.5)), count - 1);
}

double VaryingNumber::least() const {
    return picture != nullptr ? factor * *std::ranges::min_element(picture->value) : factor;
}

double VaryingNumber::most() const {
    return picture != nullptr ? factor * *std::ranges::max_element(picture->value) : factor;
}

void prepare(MetallicMaterial& material) {
    const double least = material.roughness.least();
    const double most = material.roughness.most();
    const bool has_matter = material.metallic.least() < 1.0;
    material.facets = std::make_shared<const FacetSteps>(
        material.eta, least * least, most * most,
        FacetSteps::Wanted{.is_metal = material.metallic.most() > 0.0,
                           .is_plastic = has_matter && material.transmission.least() < 1.0,
                           .is_glass = has_matter && material.transmission.most() > 0.0 && material.is_body});
    for (std::size_t i = 0; i <= kMetalSteps; ++i) {
        const float rho = static_cast<float>(i) / kMetalSteps;
        material.metal_means.push_back(
            mean_conductor_reflectance(spectral::SpectralSample(1.0F), spectral::SpectralSample(metal_k(rho)))[0]);
    }
}

MixBsdf at_point(const MetallicMaterial& material, const Vec2d& uv, const spectral::PathWavelengths& path) {
    const double metallic = std::clamp(material.metallic.at(uv), 0.0, 1.0);
    const double transmission = std::clamp(material.transmission.at(uv), 0.0, 1.0);
    const double alpha = std::pow(std::clamp(material.roughness.at(uv), 0.0, 1.0), 2);
    const Roughness roughness = resolvable({.alpha_x = alpha, .alpha_y = alpha});
    const spectral::SpectralSample base = value_at(material.base_colour, uv, path);
    MixBsdf mix;
    const auto add = [&](double fraction, const auto& part) {
        if (fraction > 0.0) {
            mix.fraction[mix.count] = fraction;
            mix.part[mix.count++] = part(material, base, roughness);
        }
    };
    add(metallic, metal);
    add((1.0 - metallic) * transmission, glass);
    add((1.0 - metallic) * (1.0 - transmission), plastic);
    return mix;
}

}  // namespace lensproof::scene
