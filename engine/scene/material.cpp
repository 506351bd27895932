#include "engine/scene/material.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "engine/base/input_error.h"

namespace lensproof::scene {

namespace {

DiffuseBsdf at_point(const DiffuseMaterial& material, const Vec2d& uv, const spectral::PathWavelengths& path) {
    return {.albedo = value_at(material.albedo, uv, path)};
}

ConductorBsdf at_point(const ConductorMaterial& material, const Vec2d&, const spectral::PathWavelengths& path) {
    if (material.roughness.is_smooth()) {
        return {.n = material.n(path), .k = material.k(path)};
    }
    return {.n = material.n(path),
            .k = material.k(path),
            .roughness = material.roughness,
            .losses = material.losses.get(),
            .given_back = material.given_back(path)};
}

DielectricBsdf at_point(const DielectricMaterial& material, const Vec2d&, const spectral::PathWavelengths& path) {
    return {.eta = material.eta(path), .roughness = material.roughness, .losses = material.losses.get()};
}

PlasticBsdf at_point(const PlasticMaterial& material, const Vec2d& uv, const spectral::PathWavelengths& path) {
    return plastic_bsdf(value_at(material.albedo, uv, path), *material.coat);
}

double share_at(const MixMaterial::Part& part, const Vec2d& uv) {
    double share = 1.0;
    for (const MixMaterial::Factor& factor : part.factors) {
        const double value = value_at(factor.share, uv);
        share *= factor.is_complement ? 1.0 - value : value;
    }
    return share;
}

MixBsdf at_point(const MixMaterial& material, const Vec2d& uv, const spectral::PathWavelengths& path) {
    MixBsdf mix;
    for (const MixMaterial::Part& part : material.parts) {
        const double share = share_at(part, uv);
        if (share > 0.0) {
            mix.share[mix.count] = share;
            mix.part[mix.count] =
                std::visit([&](const auto& simple) -> SimpleBsdf { return at_point(simple, uv, path); }, part.material);
            ++mix.count;
        }
    }
    return mix;
}

std::vector<MixMaterial::Part> parts_of(const Material& material) {
    if (const auto* mix = std::get_if<MixMaterial>(&material.surface)) {
        return mix->parts;
    }
    std::vector<MixMaterial::Part> parts(1);
    std::visit(
        [&](const auto& surface) {
            if constexpr (!std::is_same_v<std::decay_t<decltype(surface)>, MixMaterial>) {
                parts[0].material = surface;
            }
        },
        material.surface);
    return parts;
}

}  // namespace

ConductorMaterial conductor_material(spectral::GridSpectrum n, spectral::GridSpectrum k, const Roughness& roughness) {
    ConductorMaterial material{.n = std::move(n), .k = std::move(k), .roughness = resolvable(roughness)};
    if (material.roughness.is_smooth()) {
        return material;
    }
    material.losses = std::make_shared<FacetLosses>(FacetLosses::of_mirrors(material.roughness));
    for (std::size_t i = 0; i < material.n.value.size(); ++i) {
        const spectral::SpectralSample mean = mean_conductor_reflectance(spectral::SpectralSample(material.n.value[i]),
                                                                         spectral::SpectralSample(material.k.value[i]));
        material.given_back.value.push_back(static_cast<float>(given_back(mean[0], material.losses->mean())));
    }
    return material;
}

DielectricMaterial dielectric_material(spectral::GridSpectrum eta, const Roughness& roughness) {
    DielectricMaterial material{.eta = std::move(eta), .roughness = resolvable(roughness)};
    if (!material.roughness.is_smooth()) {
        const auto [least, most] = std::minmax_element(material.eta.value.begin(), material.eta.value.end());
        material.losses = std::make_shared<BoundaryLosses>(material.roughness, *least, *most);
    }
    return material;
}

PlasticMaterial plastic_material(Texture albedo, double eta, double alpha) {
    return {.albedo = std::move(albedo), .coat = std::make_shared<DielectricCoat>(eta, alpha)};
}

MixMaterial mixed(const Material& first, const Material& second, const ScalarTexture& share) {
    MixMaterial mix;
    for (const bool is_complement : {true, false}) {
        for (MixMaterial::Part& part : parts_of(is_complement ? first : second)) {
            part.factors.push_back({.share = share, .is_complement = is_complement});
            mix.parts.push_back(std::move(part));
        }
    }
    if (mix.parts.size() > kMostMixed) {
        throw InputError(fmt::format("a mix of {} materials, expected at most {}", mix.parts.size(), kMostMixed));
    }
    return mix;
}

Bsdf bsdf_at(const Material& material, const Vec2d& uv, const spectral::PathWavelengths& path) {
    return std::visit([&](const auto& surface) -> Bsdf { return at_point(surface, uv, path); }, material.surface);
}

spectral::SpectralSample radiance_at(const Material& material, const Vec2d& uv, const spectral::PathWavelengths& path) {
    return material.radiance ? value_at(*material.radiance, uv, path) : spectral::SpectralSample();
}

}  // namespace lensproof::scene
