#include "engine/scene/material.h"

#include <fmt/format.h>

#include "engine/io/input_error.h"

namespace lensproof {

namespace {

DiffuseBsdf at_point(const DiffuseMaterial& material, const Vec2d& uv, const PathWavelengths& path) {
    return {.albedo = value_at(material.albedo, uv, path)};
}

ConductorBsdf at_point(const ConductorMaterial& material, const Vec2d&, const PathWavelengths& path) {
    return {.n = material.n(path), .k = material.k(path), .roughness = material.roughness};
}

DielectricBsdf at_point(const DielectricMaterial& material, const Vec2d&, const PathWavelengths& path) {
    return {.eta = material.eta(path), .roughness = material.roughness};
}

PlasticBsdf at_point(const PlasticMaterial& material, const Vec2d& uv, const PathWavelengths& path) {
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

MixBsdf at_point(const MixMaterial& material, const Vec2d& uv, const PathWavelengths& path) {
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

Bsdf bsdf_at(const Material& material, const Vec2d& uv, const PathWavelengths& path) {
    return std::visit([&](const auto& surface) -> Bsdf { return at_point(surface, uv, path); }, material.surface);
}

SpectralSample radiance_at(const Material& material, const Vec2d& uv, const PathWavelengths& path) {
    return material.radiance ? value_at(*material.radiance, uv, path) : SpectralSample();
}

}  // namespace lensproof
