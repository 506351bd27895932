#include "engine/scene/bsdf/bsdf.h"

#include <algorithm>

#include "engine/scene/bsdf/fresnel.h"

namespace lensproof::scene {

namespace {

bool is_delta(const DiffuseBsdf&) {
    return false;
}

bool is_delta(const ConductorBsdf& bsdf) {
    return bsdf.roughness.is_smooth();
}

bool is_delta(const PaneBsdf&) {
    return true;
}

bool is_delta(const PlasticBsdf& bsdf) {
    return bsdf.roughness.is_smooth() && spectral::is_black(bsdf.base);
}

bool is_delta(const MixBsdf& bsdf) {
    return std::all_of(
        bsdf.part.begin(), bsdf.part.begin() + static_cast<std::ptrdiff_t>(bsdf.count),
        [](const auto& part) { return std::visit([](const auto& model) { return is_delta(model); }, part); });
}

spectral::SpectralSample normal_albedo(const DiffuseBsdf& bsdf) {
    return bsdf.albedo;
}

spectral::SpectralSample normal_albedo(const ConductorBsdf& bsdf) {
    return conductor_reflectance(bsdf.n, bsdf.k, 1.0);
}

/// Of what reflects as much and tints the rest.
spectral::SpectralSample with_tint(const spectral::SpectralSample& reflected, const spectral::SpectralSample& tint) {
    const spectral::SpectralSample all(1.0F);
    return all - (all - reflected) * (all - tint);
}

spectral::SpectralSample normal_albedo(const DielectricBsdf& bsdf) {
    return with_tint(spectral::for_each_wavelength(
                         [](float eta) { return static_cast<float>(dielectric_reflectance(eta, 1.0)); }, bsdf.eta),
                     bsdf.tint);
}

spectral::SpectralSample normal_albedo(const PaneBsdf& bsdf) {
    return with_tint(pane_reflectance(bsdf, 1.0), bsdf.tint);
}

spectral::SpectralSample normal_albedo(const PlasticBsdf& bsdf) {
    const auto coat = static_cast<float>(bsdf.coat->reflectance(1.0));
    return spectral::SpectralSample(coat) + (1.0F - coat) * bsdf.base;
}

spectral::SpectralSample normal_albedo(const MixBsdf& bsdf) {
    spectral::SpectralSample sum;
    for (std::size_t i = 0; i < bsdf.count; ++i) {
        sum += static_cast<float>(bsdf.fraction[i]) *
               std::visit([](const auto& part) { return normal_albedo(part); }, bsdf.part[i]);
    }
    return sum;
}

/// But of a mix.
template <class Model>
bool has_delta_of(const Model& bsdf) {
    return is_delta(bsdf);
}
bool has_delta_of(const PlasticBsdf& bsdf) {
    return bsdf.roughness.is_smooth();
}

}  // namespace

spectral::SpectralSample evaluate(const Bsdf& bsdf, const Vec3d& wo, const Vec3d& wi, Transport transport) {
    return std::visit([&](const auto& model) { return evaluate(model, wo, wi, transport); }, bsdf);
}

double pdf(const Bsdf& bsdf, const Vec3d& wo, const Vec3d& wi, Transport transport) {
    return std::visit([&](const auto& model) { return pdf(model, wo, wi, transport); }, bsdf);
}

std::optional<BsdfSample> sample(const Bsdf& bsdf, const Vec3d& wo, const BsdfNumbers& numbers, Transport transport) {
    return std::visit([&](const auto& model) { return sample(model, wo, numbers, transport); }, bsdf);
}

bool has_delta(const Bsdf& bsdf) {
    const auto of = [](const auto& model) { return has_delta_of(model); };
    if (const auto* mix = std::get_if<MixBsdf>(&bsdf)) {
        return std::any_of(mix->part.begin(), mix->part.begin() + static_cast<std::ptrdiff_t>(mix->count),
                           [&](const auto& part) { return std::visit(of, part); });
    }
    return std::visit(of, bsdf);
}

bool is_delta(const Bsdf& bsdf) {
    return std::visit([](const auto& model) { return is_delta(model); }, bsdf);
}

spectral::SpectralSample normal_albedo(const Bsdf& bsdf) {
    return std::visit([](const auto& model) { return normal_albedo(model); }, bsdf);
}

}  // namespace lensproof::scene
