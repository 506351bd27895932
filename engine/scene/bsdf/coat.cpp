#include "engine/scene/bsdf/coat.h"

#include <algorithm>
#include <cmath>

#include "engine/scene/bsdf/facet_mean.h"
#include "engine/scene/bsdf/fresnel.h"

namespace lensproof::scene {

namespace {

constexpr int kTableSteps = 128;
constexpr double kGrazing = 1e-6;

/// E(μ) of a rough boundary: the mean over the visible facets of what they reflect past the others.
double facets_reflectance(double eta, const Roughness& roughness, double mu) {
    const Vec3d wo{std::sqrt((1.0 - mu) * (1.0 + mu)), 0.0, mu};
    return visible_facet_mean(roughness, wo, [&](const Vec3d& m) {
        const Vec3d wi = reflected(wo, m);
        return wi.z > 0.0
                   ? dielectric_reflectance(eta, std::min(dot(wo, m), 1.0)) * ggx_reflection_weight(roughness, wo, wi)
                   : 0.0;
    });
}

}  // namespace

DielectricCoat::DielectricCoat(double eta, double alpha)
    : eta_(eta), roughness_(resolvable({.alpha_x = alpha, .alpha_y = alpha})) {
    if (!roughness_.is_smooth()) {
        for (int i = 0; i <= kTableSteps; ++i) {
            const double mu = std::max(kGrazing, static_cast<double>(i) / kTableSteps);
            table_.push_back(static_cast<float>(facets_reflectance(eta_, roughness_, mu)));
        }
        // Of straight lines between the entries, exactly.
        constexpr double kStep = 1.0 / kTableSteps;
        for (int i = 0; i < kTableSteps; ++i) {
            const double mu = i * kStep;
            const auto index = static_cast<std::size_t>(i);
            mean_reflectance_ +=
                kStep * (table_[index] * (mu + kStep / 3.0) + table_[index + 1] * (mu + 2.0 * kStep / 3.0));
        }
    } else {
        mean_reflectance_ =
            integral_over_unit<60>([&](double mu) { return 2.0 * mu * dielectric_reflectance(eta_, mu); });
    }
}

double DielectricCoat::reflectance(double mu) const {
    if (table_.empty()) {
        return dielectric_reflectance(eta_, std::min(mu, 1.0));
    }
    const double place = std::clamp(mu, 0.0, 1.0) * kTableSteps;
    const int step = std::min(static_cast<int>(place), kTableSteps - 1);
    const auto index = static_cast<std::size_t>(step);
    return table_[index] + (place - step) * (static_cast<double>(table_[index + 1]) - table_[index]);
}

double DielectricCoat::mean_reflectance_below() const {
    return 1.0 - (1.0 - mean_reflectance_) / (eta_ * eta_);
}

}  // namespace lensproof::scene
