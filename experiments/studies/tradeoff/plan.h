// experiments/studies/tradeoff/plan.h — which effects of its lens and its light a picture needs at a tolerance, and the
// cheapest way to render them.
#pragma once
#include <string>
#include <vector>

#include "engine/base/json.h"
#include "engine/render/film/smoothed_film.h"
#include "experiments/studies/tradeoff/effects.h"
#include "experiments/studies/tradeoff/rungs.h"

namespace lensproof::studies {

/// How a picture is to be rendered.
struct PlannedRender {
    Rung rung;
    int max_bounces = 0;
    std::vector<std::string> passes;         // beside what goes straight
    std::vector<render::SmoothPass> smooth;  // of these

    /// Whether it has fewer wavelengths or scatterings than the scene.
    [[nodiscard]] bool is_reduced(const render::SceneSetup& setup) const {
        return rung.wavelengths.has_value() || max_bounces < setup.max_bounces;
    }
};

/// What may take a render's place where it errs by too much, from the cheapest on: the cameras that err less, and at
/// last the full model's straight light.
std::vector<PlannedRender> dearer_renders(const PlannedRender& planned, const render::SceneSetup& full);

/// What a plan gets wrong at some of the scene's own pixels (spot_check.h).
struct Spots {
    int pixels = 0;  // 0: not looked at
    Contribution error;
    bool is_revised = false;
};

/// An effect with what was decided of it.
struct PlannedEffect {
    Effect effect;
    bool is_modelled = false;
    double saves_percent = 0.0;  // of the full model's time, where it is left out
    std::string why;
};

struct Plan {
    Tolerance tolerance;
    std::vector<PlannedEffect> effects;
    PlannedRender render;
    /// What the planned render gets wrong against the full model, by pictures of other seeds than those that the
    /// effects were found by. Passes are not in it. A model is refused where it surely errs by more than the tolerance.
    Contribution checked;
    std::vector<std::string> refused;  // cheaper models that the check refused, and why
    Spots spots;
    double noise_ev = 0.0;  // of a pixel, rms, with the scene's own samples
    double speed_up = 1.0;  // a sample's time with the full model, all its passes, over the planned one's
    double probe_seconds = 0.0;
};

/// The full model's passes of stray light that a plan is held to: all but those that it leaves out for a bound.
std::vector<std::string> accountable_passes(const Plan& plan);

/// Plans a scene's render from a pilot of a few thousand pixels. Throws InputError where the scene's camera has no
/// lens.
Plan plan_render(const render::SceneSetup& setup, const Tolerance& tolerance, const PilotSettings& settings);

/// What a planned render gets wrong against the full model, by pictures of the settings' seeds and rays of their own;
/// and what a sample of both takes, ns of one core. `passes`: of stray light that the full model has; of them the plan
/// has what it decided.
struct PlannedCheck {
    Contribution error;
    double ns_per_sample = 0.0;
    double full_ns_per_sample = 0.0;
};
PlannedCheck check_plan(const render::SceneSetup& setup, const PlannedRender& planned,
                        const std::vector<std::string>& passes, const PilotSettings& settings);

/// The scene as it is to be rendered.
render::SceneSetup planned_setup(render::SceneSetup setup, const PlannedRender& planned);

/// As the command line's contract has it; without what was timed (probe_seconds, speed_up, saves_percent) it is the
/// same in every run, and may stand in a picture's file.
enum class PlanTimes { told, left_out };
Json plan_json(const Plan& plan, PlanTimes times = PlanTimes::told);

}  // namespace lensproof::studies
