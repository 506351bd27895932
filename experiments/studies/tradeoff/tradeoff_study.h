// experiments/studies/tradeoff/tradeoff_study.h — [[tradeoff]]: what each model of a scene's camera gets wrong and what
// it costs, as findings.
#pragma once
#include <string>
#include <vector>

#include "engine/base/json.h"
#include "experiments/findings/study.h"
#include "experiments/studies/tradeoff/rungs.h"

namespace lensproof::studies {

/// The errors that a check may hold a rung to, and JSON tells, in this order: position_rms_um, image_rms_px,
/// blur_rms_px, exposure_ev, ciede2000_mean, flip.
struct RungError {
    const char* key;
    const char* title;
    const char* unit;
    Measured (*of)(const MeasuredRung& rung);
};
const std::vector<RungError>& rung_errors();

struct TradeoffCheck {
    std::string rung;
    std::string error;  // its key
    double at_most = 0.0;
};

/// One of the tables (experiments/README.md).
struct TradeoffScene {
    std::string name;
    std::string title;
    std::filesystem::path file;  // the scene's
    std::string stated;          // all that the scene's file says
    render::SceneSetup setup;
    std::vector<Rung> rungs;
    TradeoffSettings settings;
    std::vector<TradeoffCheck> checks;
};

/// The rungs of these names, in the ladder's order, with the reference; all of it for none.
std::vector<Rung> rungs_named(const std::vector<std::string>& names);
std::vector<std::string> rung_names();

findings::Study read_tradeoff(findings::ExperimentFile& file);

/// As the command line's contract has it: {"reference", "rungs": [{"model", "error": {KEY, KEY_standard_error, …},
/// "cost": {…}, "pareto", "fields": [{"image_height", …}]}]}; of a model that the lens has not, "not_applicable" in the
/// place of numbers.
Json tradeoff_json(const std::vector<MeasuredRung>& rungs);

/// Error against cost, a panel for each of image_rms_px, exposure_ev and ciede2000_mean with its own front. SVG.
std::string pareto_svg(const std::string& title, const std::vector<MeasuredRung>& rungs, double noise);

/// A subject a rung, with its picture; the fronts; the errors over the image height; with an entry of the table
/// "tradeoff": {"name", and what tradeoff_json says}.
findings::Findings tradeoff_findings(const TradeoffScene& scene, const std::vector<MeasuredRung>& rungs);

}  // namespace lensproof::studies
