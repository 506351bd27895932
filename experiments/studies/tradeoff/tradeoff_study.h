// experiments/studies/tradeoff/tradeoff_study.h — [[tradeoff]]: what each model of a scene's camera gets wrong and what
// it costs, over many scenes and lenses.
#pragma once
#include <string>
#include <vector>

#include "experiments/findings/study.h"
#include "experiments/studies/tradeoff/rungs.h"

namespace lensproof::studies {

/// The rungs of these names, in the ladder's order, with the reference; all of it for none.
std::vector<Rung> rungs_named(const std::vector<std::string>& names);
std::vector<std::string> rung_names();

/// The tables: name, title, scene and the rest (experiments/README.md); with cases = [{ name, scene = { … } }], each of
/// which is put over the scene, one of each case.
std::vector<findings::Study> read_tradeoff(findings::ExperimentFile& file);

}  // namespace lensproof::studies
