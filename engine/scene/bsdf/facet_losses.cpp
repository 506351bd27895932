#include "engine/scene/bsdf/facet_losses.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/optics/refract.h"
#include "engine/scene/bsdf/facet_mean.h"
#include "engine/scene/bsdf/fresnel.h"

namespace lensproof::scene {

namespace {

constexpr int kRootSteps = 40;    // of √μ: losses grow towards grazing
constexpr int kAzimuthSteps = 8;  // of sin², in which α² is linear
constexpr int kIndexSteps = 4;    // across a glass's dispersion
constexpr double kLeastCosine = 1e-6;

/// μ² at a step of √μ.
double mu2_of(int step) {
    const double root = static_cast<double>(step) / kRootSteps;
    return root * root * root * root;
}

Vec3d direction_of(double mu, double sin2_azimuth) {
    const double sine = std::sqrt((1.0 - mu) * (1.0 + mu));
    return {sine * std::sqrt(1.0 - sin2_azimuth), sine * std::sqrt(sin2_azimuth), mu};
}

/// What facets of reflectance R(cos) reflect past the others.
template <class Reflectance>
double reflected_fraction(const Roughness& roughness, const Vec3d& w, const Vec3d& m, const Reflectance& reflectance) {
    const Vec3d onwards = reflected(w, m);
    return onwards.z > 0.0 ? reflectance(std::min(dot(w, m), 1.0)) * ggx_reflection_weight(roughness, w, onwards) : 0.0;
}

/// What a facet refracts past the others on the far side.
double refracted_fraction(const Roughness& roughness, const Vec3d& w, const Vec3d& m, double eta) {
    const double cosine = std::min(dot(w, m), 1.0);
    const auto onwards = optics::refract(-1.0 * w, -1.0 * m, cosine, 1.0 / eta);
    if (!onwards.transmitted || !(onwards.direction.z < 0.0)) {
        return 0.0;
    }
    const Vec3d beyond{onwards.direction.x, onwards.direction.y, -onwards.direction.z};
    return (1.0 - dielectric_reflectance(eta, cosine)) * ggx_visible_per_cos(roughness, beyond) * beyond.z;
}

}  // namespace

template <class Returned>
FacetLosses::FacetLosses(const Roughness& roughness, const Returned& returned)
    : azimuth_steps_(roughness.alpha_x == roughness.alpha_y ? 0 : kAzimuthSteps) {
    for (int row = 0; row <= azimuth_steps_; ++row) {
        const double sin2_azimuth = azimuth_steps_ == 0 ? 0.0 : static_cast<double>(row) / azimuth_steps_;
        for (int i = 0; i <= kRootSteps; ++i) {
            const double root = static_cast<double>(i) / kRootSteps;
            const Vec3d w = direction_of(std::max(kLeastCosine, root * root), sin2_azimuth);
            const double fraction = visible_facet_mean(roughness, w, [&](const Vec3d& m) { return returned(w, m); });
            table_.push_back(static_cast<float>(std::max(0.0, 1.0 - fraction)));
        }
    }
    // Over √μ in panels, a polynomial in each; over azimuths evenly.
    const int azimuths = azimuth_steps_ == 0 ? 1 : 64;
    cumulative_.push_back(0.0);
    for (int i = 0; i < kRootSteps; ++i) {
        for (int j = 0; j < azimuths; ++j) {
            const double sine = std::sin(0.5 * std::numbers::pi * (j + 0.5) / azimuths);
            mean_ += integral_over_unit<7>([&](double within) {
                         const double root = (i + within) / kRootSteps;
                         return interpolated(root * root, sine * sine) * 4.0 * root * root * root;
                     }) /
                     (kRootSteps * azimuths);
        }
        cumulative_.push_back(mean_);
    }
    for (int i = 1; i <= kRootSteps; ++i) {
        // A surface without losses draws evenly, where it draws at all.
        double& cumulative = cumulative_[static_cast<std::size_t>(i)];
        cumulative = mean_ > 0.0 ? cumulative / mean_ : std::pow(static_cast<double>(i) / kRootSteps, 4);
    }
}

FacetLosses FacetLosses::of_mirrors(const Roughness& roughness) {
    return {roughness, [&](const Vec3d& w, const Vec3d& m) {
                return reflected_fraction(roughness, w, m, [](double) { return 1.0; });
            }};
}

FacetLosses FacetLosses::of_boundary(const Roughness& roughness, double eta) {
    return {roughness, [&](const Vec3d& w, const Vec3d& m) {
                const auto fresnel = [&](double cosine) { return dielectric_reflectance(eta, cosine); };
                return reflected_fraction(roughness, w, m, fresnel) + refracted_fraction(roughness, w, m, eta);
            }};
}

double FacetLosses::interpolated(double mu, double sin2_azimuth) const {
    const double place = std::sqrt(std::clamp(mu, 0.0, 1.0)) * kRootSteps;
    const int step = std::min(static_cast<int>(place), kRootSteps - 1);
    const auto along_mu = [&](int row) {
        const int index = row * (kRootSteps + 1) + step;
        const float* const entry = &table_[static_cast<std::size_t>(index)];
        return entry[0] + (place - step) * (static_cast<double>(entry[1]) - entry[0]);
    };
    if (azimuth_steps_ == 0) {
        return along_mu(0);
    }
    const double azimuth_place = std::clamp(sin2_azimuth, 0.0, 1.0) * azimuth_steps_;
    const int row = std::min(static_cast<int>(azimuth_place), azimuth_steps_ - 1);
    const double first = along_mu(row);
    return first + (azimuth_place - row) * (along_mu(row + 1) - first);
}

double FacetLosses::at(const Vec3d& w) const {
    const double sine2 = w.x * w.x + w.y * w.y;
    return interpolated(w.z, azimuth_steps_ > 0 && sine2 > 0.0 ? w.y * w.y / sine2 : 0.0);
}

Vec3d FacetLosses::sample(double u1, double u2) const {
    const auto above = std::upper_bound(cumulative_.begin() + 1, cumulative_.end() - 1, u1);
    const auto panel = static_cast<int>(above - cumulative_.begin()) - 1;
    const double from = *(above - 1);
    const double within = std::clamp((u1 - from) / (*above - from), 0.0, 1.0);
    // Evenly in μ², as light falls, within a step.
    const double first = mu2_of(panel);
    const double mu = std::sqrt(first + within * (mu2_of(panel + 1) - first));
    const double sine = std::sqrt(std::max(0.0, (1.0 - mu) * (1.0 + mu)));
    const double angle = 2.0 * std::numbers::pi * u2;
    return {sine * std::cos(angle), sine * std::sin(angle), mu};
}

double FacetLosses::pdf(const Vec3d& w) const {
    const int panel = std::min(static_cast<int>(std::sqrt(w.z) * kRootSteps), kRootSteps - 1);
    const auto index = static_cast<std::size_t>(panel);
    const double probability = cumulative_[index + 1] - cumulative_[index];
    return w.z * std::numbers::inv_pi * probability / (mu2_of(panel + 1) - mu2_of(panel));
}

BoundaryLosses::BoundaryLosses(const Roughness& roughness, double least_eta, double most_eta)
    : least_eta_(least_eta), step_((most_eta - least_eta) / kIndexSteps) {
    const int count = most_eta > least_eta ? kIndexSteps + 1 : 1;
    for (int i = 0; i < count; ++i) {
        const double eta = least_eta + i * step_;
        above_.push_back(FacetLosses::of_boundary(roughness, eta));
        below_.push_back(FacetLosses::of_boundary(roughness, 1.0 / eta));
    }
}

BoundaryLosses::Loss BoundaryLosses::of(const Vec3d& w, double eta) const {
    const std::vector<FacetLosses>& side = w.z > 0.0 ? above_ : below_;
    const std::vector<FacetLosses>& beyond = w.z > 0.0 ? below_ : above_;
    const Vec3d upward{w.x, w.y, std::abs(w.z)};
    if (side.size() == 1) {
        return {.at_direction = side[0].at(upward), .mean = side[0].mean(), .mean_beyond = beyond[0].mean()};
    }
    const double place = std::clamp((eta - least_eta_) / step_, 0.0, static_cast<double>(kIndexSteps));
    const std::size_t first = std::min(static_cast<std::size_t>(place), side.size() - 2);
    const double fraction = place - static_cast<double>(first);
    const auto between = [&](double a, double b) { return a + fraction * (b - a); };
    return {.at_direction = between(side[first].at(upward), side[first + 1].at(upward)),
            .mean = between(side[first].mean(), side[first + 1].mean()),
            .mean_beyond = between(beyond[first].mean(), beyond[first + 1].mean())};
}

const FacetLosses& BoundaryLosses::nearest(bool is_above, double eta) const {
    const std::vector<FacetLosses>& side = is_above ? above_ : below_;
    if (side.size() == 1) {
        return side[0];
    }
    const double place = std::clamp((eta - least_eta_) / step_, 0.0, static_cast<double>(kIndexSteps));
    return side[static_cast<std::size_t>(std::lround(place))];
}

double given_back(double mean_reflectance, double mean_loss) {
    return mean_reflectance * mean_reflectance * (1.0 - mean_loss) / (1.0 - mean_reflectance * mean_loss);
}

}  // namespace lensproof::scene
