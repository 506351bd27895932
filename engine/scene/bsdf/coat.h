// engine/scene/bsdf/coat.h — a clear varnish over a surface: what it reflects before light gets under it.
#pragma once
#include <vector>

#include "engine/scene/bsdf/ggx.h"

namespace lensproof::scene {

/// A clear layer of index `eta` (> 1) without absorption or dispersion; smooth, or rough alike in every direction.
class DielectricCoat {
  public:
    /// `alpha`: the facets' slope as in Roughness, 0 for smooth.
    DielectricCoat(double eta, double alpha);

    [[nodiscard]] double eta() const { return eta_; }
    [[nodiscard]] const Roughness& roughness() const { return roughness_; }

    /// E(μ): the fraction of light from a direction of cosine `mu` in (0, 1] that the top of the coat reflects, by
    /// single reflections at facets where it is rough; tabulated then, within 1e-3.
    [[nodiscard]] double reflectance(double mu) const;

    /// 2 ∫ E(μ) μ dμ: of light that comes evenly from the whole hemisphere.
    [[nodiscard]] double mean_reflectance() const { return mean_reflectance_; }

    /// The fraction of evenly spread light from below that the coat throws back down: 1 − (1 − mean_reflectance) / η²,
    /// as in equilibrium as much passes up as down and radiance below is η² times that above.
    [[nodiscard]] double mean_reflectance_below() const;

  private:
    double eta_;
    Roughness roughness_;
    std::vector<float> table_;  // E at even steps of μ from 0 to 1; empty where smooth
    double mean_reflectance_ = 0.0;
};

}  // namespace lensproof::scene
