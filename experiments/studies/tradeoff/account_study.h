// experiments/studies/tradeoff/account_study.h — [[planned]]: plans held to account, over many scenes and lenses.
#pragma once
#include <string>
#include <vector>

#include "experiments/findings/study.h"
#include "experiments/studies/tradeoff/effect_account.h"
#include "experiments/studies/tradeoff/plan.h"
#include "experiments/studies/tradeoff/scene_case.h"

namespace lensproof::studies {

/// What a plan said of a case, and what came of it: the planned render against the full model with seeds that the plan
/// has not seen and more samples. The full model's stray light is in it, but for what only a bound speaks of: faint
/// ghosts and diffraction, unless the plan renders them.
struct PlannedOutcome {
    std::string name;
    std::string model;
    Contribution predicted;  // by the plan's own check
    Contribution measured;
    double speed_up = 1.0;
    double probe_seconds = 0.0;
    std::vector<EffectAccount> effects;
    std::string refused;  // why there is no plan; else empty
};
void fields(JsonArchive& json, PlannedOutcome& outcome);

PlannedOutcome hold_to_account(const SceneCase& planned, const Tolerance& tolerance, const PilotSettings& settings);

/// Whether the measured error keeps the tolerance, as far as it is known: no part of it surely exceeds (by two standard
/// errors) what may be.
bool keeps_tolerance(const PlannedOutcome& outcome, const Tolerance& tolerance);

/// The tables: name, title (optional), scene, tolerance, cases = [{ name, scene = { … } }], each of which is put over
/// the scene. Findings: how many keep the tolerance, with the binomial's standard error; that none is slower than the
/// full model by more than a twentieth; each effect's contribution as predicted against the measured one, and how many
/// error bars hold it; a table "planned" of all.
std::vector<findings::Study> read_planned(findings::ExperimentFile& file);

}  // namespace lensproof::studies
