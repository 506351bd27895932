// experiments/studies/tradeoff/effect_account.h — what a plan predicted of each effect, against renders with it and
// without.
#pragma once
#include <string>
#include <vector>

#include "experiments/studies/tradeoff/plan.h"

namespace lensproof::studies {

/// One effect, or some that no two models tell apart: then their contributions together.
struct EffectAccount {
    std::string effects;
    bool is_bound = false;  // the prediction is
    Contribution predicted;
    Contribution measured;
};
void fields(JsonArchive& json, Contribution& contribution);
void fields(JsonArchive& json, EffectAccount& account);

/// By pictures of the settings' seeds, which the plan has not seen, and of the scene's own pixels (`window_pictures`):
/// defocus as what a thin lens makes otherwise than a pinhole; distortion, lateral colour and vignetting as what the
/// profile makes of a thin lens; aberrations as what the lens itself makes otherwise than a thin lens with its profile.
/// Places by the lens itself, closed down to f/64: what it makes otherwise than a pinhole is distortion and lateral
/// colour, and what it makes otherwise when opened is aberration.
/// By pictures of the pilot's pixels: stray light by its passes; and fewer wavelengths and scatterings, where the plan
/// has fewer. Effects that nothing renders apart are not in it: cos⁴ and losses.
std::vector<EffectAccount> account_effects(const render::SceneSetup& setup, const Plan& plan,
                                           const PilotSettings& settings);

/// Whether the measured value is the predicted one within two standard errors of both, or within `slack`; of a bound,
/// no more than it by so much.
bool covers(const Measured& predicted, const Measured& measured, bool is_bound, double slack);

}  // namespace lensproof::studies
