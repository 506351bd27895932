// experiments/studies/stray_light/render_variant.h — what is found of a variant of a scene: its passes' pictures, how
// much light each has, and where all light goes.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "engine/base/json_archive.h"
#include "engine/base/power_law.h"
#include "engine/formats/image/image.h"
#include "experiments/findings/study.h"
#include "experiments/studies/stray_light/growing_picture.h"
#include "experiments/studies/stray_light/stray_scene.h"
#include "experiments/studies/stray_light/streak_look.h"

namespace lensproof::studies {

/// A number with its standard error.
struct Estimate {
    double value = 0.0;
    double standard_error = 0.0;
};

/// Their errors are taken to be independent.
Estimate ratio(const Estimate& over, const Estimate& under);

/// What a pass makes.
struct PassPicture {
    std::string pass;
    formats::Image rgb;  // linear, 1 = saturation
    Estimate light;      // the mean of R, G and B over the picture
    /// The standard error of each pixel's mean of R, G and B. No pixels where there are so few samples that it is not
    /// known.
    formats::Image error;
};

/// A ghost of two reflections.
struct GhostEnergy {
    std::vector<int> surfaces;  // from 1
    Estimate energy;            // of the light that enters the entrance pupil
};

struct VariantFindings {
    std::vector<PassPicture> passes;
    std::vector<GhostEnergy> ghosts;        // the strongest first, where they are asked for
    std::optional<Estimate> veiling_glare;  // a fraction
    std::vector<ChartFeature> features;     // of the chart, where one is measured
    std::optional<StreakLook> streaks;
    std::vector<PictureGrowth> growth;
    std::vector<std::pair<std::string, Estimate>> fates;  // of the light that comes in, shares, by their names

    /// Of a pass, or of all together.
    [[nodiscard]] Estimate light(const std::string& pass) const;
    /// Of all together as it is printed: the standard error of a pixel's displayed value (sRGB, white being 1), root
    /// mean square over the frame. Nothing where a pass's is not known.
    [[nodiscard]] std::optional<double> noise() const;
    /// Of the ghosts that the surface reflects, or of the others.
    [[nodiscard]] Estimate ghost_energy(int surface, bool is_involved) const;
};

/// The variants' features, for a chart that is measured.
std::vector<VariantFeatures> features_of(const StrayScene& scene, const std::vector<VariantFindings>& variants);

/// Of the sum's error over its time.
PowerLaw growth_law(const std::vector<PictureGrowth>& growth);

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
