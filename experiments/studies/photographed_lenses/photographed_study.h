// experiments/studies/photographed_lenses/photographed_study.h — [[photographed_lenses]]: prescriptions against
// photographs of their products, as findings.
#pragma once
#include <vector>

#include "engine/base/toml.h"
#include "experiments/findings/study.h"
#include "experiments/studies/photographed_lenses/population.h"

namespace lensproof::studies {

/// What the tables ask for.
struct PhotographedSettings {
    std::vector<LensPair> pairs{};
    std::vector<std::string> others{};  // more wrong lenses
};

/// One of the tables. One pair by `lens`, `model` and, where a model needs them, `crop_factor` and `projection`; or
/// many by `pairs`, a CSV with the columns prescription, lensfun_model, crop, projection (others are left), whose
/// prescriptions lie in prescriptions/NAME.csv beside it; none where that is missing and `optional` is true.
/// `lensfun_data` names another database than the system's. Or `others`, lenses that are no pair's. Throws InputError
/// naming file, line and key.
PhotographedSettings read_photographed_table(TomlTable& table);

/// All tables' pairs; one whose model and crop factor an earlier table has is left out.
std::vector<findings::Study> read_photographed_lenses(findings::ExperimentFile& file);

/// The population's checks (the right prescriptions' median, how many others the right one beats in the median), the
/// population drawn, each pair a subject; with a table "photographed_lenses":
///     {"summary": {…}, "pairs": [{"id", "lens", "measured", "distortion", …, "wrong": [{"lens", "residual_rms_um"}],
///      "share_beaten", "doubt"}]}
findings::Findings photographed_findings(const std::vector<PairResult>& results);

}  // namespace lensproof::studies
