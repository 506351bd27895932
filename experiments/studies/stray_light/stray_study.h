// experiments/studies/stray_light/stray_study.h — [[stray_light]]: a scene's light by its classes, in variants set
// beside each other, as findings.
#pragma once
#include <vector>

#include "experiments/findings/study.h"
#include "experiments/studies/stray_light/render_variant.h"

namespace lensproof::studies {

std::vector<findings::Study> read_stray_light(findings::ExperimentFile& file);

/// Each check's ratio, with the standard error that those of its two lights leave it; then the noise, at full quality,
/// streaks, growth and the features of charts, where they are asked for.
std::vector<findings::Check> stray_checks(const StrayScene& scene, const std::vector<VariantFindings>& variants,
                                          findings::Quality quality);

/// A subject for all variants, with a contact sheet of each pass, and one for each of them; with an entry of the table
/// "stray_light":
///     {"name", "passes": [...], "variants": [{"name", "at": {KEY: value}, "light": {PASS: {"mean", "standard_error"},
///     …}, "noise_percent",
///      "ghosts": [{"surfaces": [2, 1], "energy", "energy_standard_error"}], "veiling_glare_percent",
///      "veiling_glare_standard_error_percent", "energy": {FATE_percent, FATE_standard_error_percent, …},
///      "features": [{"field_deg", "picture": {LOOK: value, …}, "rays": {…}}], "streaks": {"offset_deg", "slope",
///      …_error}, "growth": [{"samples", "seconds", "error", "pass_errors", "pass_seconds"}]}]}
/// where light is the mean of R, G and B over the picture, 1 being saturation, and what was not asked for is left out.
findings::Findings stray_findings(const StrayScene& scene, const std::vector<VariantFindings>& variants,
                                  findings::Quality quality);

}  // namespace lensproof::studies
