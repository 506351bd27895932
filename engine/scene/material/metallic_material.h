// engine/scene/material/metallic_material.h — the metallic-roughness materials of glTF, whose every number may vary
// over the surface: metal, plastic and glass side by side.
#pragma once
#include <memory>
#include <optional>
#include <vector>

#include "engine/scene/bsdf/mix.h"
#include "engine/scene/spectra/texture.h"

namespace lensproof::scene {

/// What facets of some roughness lose and return, at even steps of GGX's α, of which the nearest serves a point: a step
/// of 1/64 moves what returns by less than 1 %. A material whose roughness does not vary has its own step.
class FacetSteps {
  public:
    struct Wanted {
        bool is_metal = false;
        bool is_plastic = false;
        bool is_glass = false;
    };

    /// Of a surface of index `eta`, for α from `least` to `most`; what is wanted of it.
    FacetSteps(double eta, double least, double most, const Wanted& wanted);

    /// Nothing where light loses nothing, or was not wanted. They live as long as this.
    [[nodiscard]] const FacetLosses* mirrors(double alpha) const { return found(mirrors_, alpha); }
    [[nodiscard]] const DielectricCoat* coat(double alpha) const { return found(coats_, alpha); }
    [[nodiscard]] const BoundaryLosses* glass(double alpha) const { return found(glass_, alpha); }

  private:
    template <class Table>
    using Steps = std::vector<std::optional<Table>>;
    template <class Table>
    [[nodiscard]] const Table* found(const Steps<Table>& steps, double alpha) const {
        const std::optional<Table>* const step = steps.empty() ? nullptr : &steps[step_of(alpha)];
        return step != nullptr && *step ? &**step : nullptr;
    }
    [[nodiscard]] std::size_t step_of(double alpha) const;

    double first_;
    double spacing_ = 0.0;  // 0: there is one
    Steps<FacetLosses> mirrors_;
    Steps<DielectricCoat> coats_;
    Steps<BoundaryLosses> glass_;
};

/// A number that is the same everywhere, or a factor of a picture's.
struct VaryingNumber {
    double factor = 1.0;
    std::shared_ptr<const NumberTexture> picture;

    [[nodiscard]] double at(const Vec2d& uv) const {
        return picture != nullptr ? factor * value_at(*picture, uv) : factor;
    }
    /// The least and the most that it may be.
    [[nodiscard]] double least() const;
    [[nodiscard]] double most() const;
};

/// With m metallic, t transmission and ρ the base colour at a point, a fraction
///
///   m              is metal of index 1 + 2i √(ρ / (1 − ρ)), which reflects ρ head on (and is within 0.02 of Schlick's
///                  curve, which glTF has, on average over the hemisphere, for ρ from 0.5; 0.05 below)
///   (1 − m) t      is glass of index `eta`: a body's boundary, whose light is tinted by √ρ each time it passes, or a
///                  pane, tinted once by ρ
///   (1 − m)(1 − t) is plastic: a matt body of reflectance ρ under a coat of index `eta`.
///
/// All are rough by α = roughness², but panes, which are clear.
struct MetallicMaterial {
    Texture base_colour;
    VaryingNumber metallic;
    VaryingNumber roughness;
    VaryingNumber transmission{.factor = 0.0};
    double eta = 1.5;
    bool is_body = false;
    std::shared_ptr<const FacetSteps> facets;
    std::vector<float> metal_means;  // F̄ of metals of ρ at even steps from 0 to 1
};

/// Finds `facets` and `metal_means`.
void prepare(MetallicMaterial& material);

/// Even ones too: it is meshes' own, whose hits have their uvs for nothing.
inline bool reads_uv(const MetallicMaterial& /*whatever*/) {
    return true;
}

MixBsdf at_point(const MetallicMaterial& material, const Vec2d& uv, const spectral::PathWavelengths& path);

}  // namespace lensproof::scene
