// experiments/studies/focus_breathing/breathing_study.h — [[focus_breathing]]: how the picture grows as a lens focuses
// nearer. The example of experiments/README.md, "A study of your own in code".
#pragma once
#include "experiments/findings/study.h"

namespace lensproof::studies {

/// Tables with `name`, `lens`, `focus_distances_mm` (inf is allowed; the first is what the others are held against),
/// `field_deg`, and optional `zoom`, a list of positions, and `at_most_percent`.
std::vector<findings::Study> read_focus_breathing(findings::ExperimentFile& file);

}  // namespace lensproof::studies
