// engine/scene/bsdf/facet_losses.h — the light that falls from one facet of a rough surface onto another.
//
// Single scattering forgets it. C. Kulla, A. Conty, "Revisiting Physically Based Shading at Imageworks" (SIGGRAPH 2017
// course) give it back as light that comes out evenly but for the same losses: with l(w) what single scattering loses
// of light from w, and L its mean over the hemisphere, f = l(wo) l(wi) / (π L), which is reciprocal and returns all of
// l(wo).
#pragma once
#include <vector>

#include "engine/scene/bsdf/ggx.h"

namespace lensproof::scene {

/// l(w) of a rough surface, tabulated.
class FacetLosses {
  public:
    /// Of facets that mirror everything.
    static FacetLosses of_mirrors(const Roughness& roughness);

    /// Of a dielectric boundary without absorption, for light from the side where w.z > 0; `eta`: the index behind it
    /// relative to that side's.
    static FacetLosses of_boundary(const Roughness& roughness, double eta);

    /// l(w) for w.z in (0, 1], in [0, 1); within 2e-3.
    [[nodiscard]] double at(const Vec3d& w) const;

    /// L = (1 / π) ∫ l(w) w.z dw, of the table to 1e-4 of itself.
    [[nodiscard]] double mean() const { return mean_; }

    /// A direction above the surface, about as l(w) w.z, from u1, u2 in (0, 1), and the pdf per solid angle at
    /// which it comes.
    [[nodiscard]] Vec3d sample(double u1, double u2) const;
    [[nodiscard]] double pdf(const Vec3d& w) const;

  private:
    template <class Returned>
    FacetLosses(const Roughness& roughness, const Returned& returned);
    [[nodiscard]] double interpolated(double mu, double sin2_azimuth) const;

    std::vector<float> table_;  // rows of even steps of sin² of the azimuth, in them even steps of √μ
    int azimuth_steps_ = 0;     // 0 for a surface that is alike all around
    double mean_ = 0.0;
    std::vector<double> cumulative_;  // of `mean_`, over steps of √μ: from 0 to 1
};

/// The same of both sides of a boundary whose index varies over wavelength.
class BoundaryLosses {
  public:
    /// `least_eta` to `most_eta`: the indices of the medium below relative to that above.
    BoundaryLosses(const Roughness& roughness, double least_eta, double most_eta);

    /// What a direction loses, the mean of its side, and that of the other.
    struct Loss {
        double at_direction = 0.0;
        double mean = 0.0;
        double mean_beyond = 0.0;
    };
    /// For `w` above (w.z > 0) or below the boundary, at an index between the two.
    [[nodiscard]] Loss of(const Vec3d& w, double eta) const;

    /// The table to draw directions above or below from; they point up in either.
    [[nodiscard]] const FacetLosses& nearest(bool is_above, double eta) const;

  private:
    std::vector<FacetLosses> above_;  // at even steps of the index
    std::vector<FacetLosses> below_;
    double least_eta_;
    double step_;
};

/// What a given-back light has of its colour: F̄² Ē / (1 − F̄ (1 − Ē)), F̄ being the facets' mean reflectance, Ē = 1 − L:
/// at least two reflections, then out (S. Hill's form, as in Kulla and Conty's notes).
double given_back(double mean_reflectance, double mean_loss);

}  // namespace lensproof::scene
