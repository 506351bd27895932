// experiments/studies/stray_light/render_variant.h — what is found of a variant of a scene: its passes' pictures, how
// much light each has, and where all light goes.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "engine/base/json_archive.h"
#include "engine/formats/image/image.h"
#include "experiments/findings/study.h"
#include "experiments/studies/stray_light/stray_scene.h"

namespace lensproof::studies {

/// A number with its standard error.
struct Estimate {
    double value = 0.0;
    double standard_error = 0.0;
};

/// What a pass makes.
struct PassPicture {
    std::string pass;
    formats::Image rgb;  // linear, 1 = saturation
    Estimate light;      // the mean of R, G and B over the picture
    double noise = 0.0;  // of a pixel's mean of R, G and B the standard error; the median over the picture
};

/// A ghost of two reflections.
struct GhostEnergy {
    std::vector<int> surfaces;  // from 1
    Estimate energy;            // of the light that enters the entrance pupil
};

struct VariantFindings {
    std::vector<PassPicture> passes;
    std::vector<GhostEnergy> ghosts;                      // the strongest first, where they are asked for
    std::optional<Estimate> veiling_glare;                // a share
    std::vector<std::pair<std::string, Estimate>> fates;  // of the light that comes in, shares, by their names

    /// Of a pass, or of all together.
    [[nodiscard]] Estimate light(const std::string& pass) const;
    /// Of a pixel of all together, over its light, both medians over the picture.
    [[nodiscard]] double noise() const;
    /// Of the ghosts that the surface reflects, or of the others.
    [[nodiscard]] Estimate ghost_energy(int surface, bool is_involved) const;
};

/// What all passes make together.
formats::Image picture_of(const std::vector<PassPicture>& passes);

/// Renders a pass after the other, each a step. Throws InputError naming the scene's file where a lens or a file of the
/// scene cannot be loaded, or its camera has no such pass.
VariantFindings render_variant(const StrayScene& scene, const StrayVariant& variant,
                               const findings::RunSettings& settings, const findings::RunProgress& progress);

/// The steps that this takes; they refer to scene and variant.
std::vector<findings::PlannedStep> steps_of_variant(const StrayScene& scene, const StrayVariant& variant,
                                                    const findings::RunSettings& settings);

}  // namespace lensproof::studies
