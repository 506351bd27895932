// experiments/studies/tradeoff/tradeoff_findings.h — what each model of scenes' cameras gets wrong and what it costs,
// as findings.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "engine/base/json.h"
#include "experiments/findings/findings.h"
#include "experiments/studies/tradeoff/sufficient_rung.h"

namespace lensproof::studies {

/// The errors that a check may hold a rung to, and JSON tells, in this order: position_rms_um, image_rms_px,
/// blur_rms_px, mtf_difference_rms, exposure_ev, ciede2000_mean, flip.
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

/// What one sees, as parse_tolerance says.
inline constexpr const char* kVisibleError = "1px,0.03ev,1de";

/// A picture through a lens: one of the tables (experiments/README.md), or one of its cases.
struct TradeoffScene {
    std::string name;
    std::string title;
    std::string picture{};  // the table's title, and the case's name; empty where it has none
    std::string lens{};
    std::vector<std::filesystem::path> files{};  // the scene's
    std::string stated{};                        // all that they say
    render::SceneSetup setup;
    std::vector<Rung> rungs;
    TradeoffSettings settings;
    std::string stated_tolerance = kVisibleError;
    std::vector<TradeoffCheck> checks{};
};

struct MeasuredScene {
    TradeoffScene scene;
    std::vector<MeasuredRung> rungs;
};

/// As the command line's contract has it: {"reference", "rungs": [{"model", "error": {KEY, KEY_standard_error, …},
/// "cost": {…}, "pareto", "fields": [{"image_height", …}]}]}; of a model that the lens has not, "not_applicable" in the
/// place of numbers.
Json tradeoff_json(const std::vector<MeasuredRung>& rungs);

/// Error against cost, a panel for each of image_rms_px, exposure_ev and ciede2000_mean with its own front. SVG.
std::string pareto_svg(const std::string& title, const std::vector<MeasuredRung>& rungs, double noise);

/// A subject for each picture with what suffices for it through each lens; one for each scene with its front, and each
/// model's picture over the reference's; one for each model. The errors over the image height. Tables "tradeoff", of
/// {"name", and what tradeoff_json says}, and "suffices", of {"picture", "lens", "tolerance", "model", "sure",
/// "times_as_fast", "largest_error", "error": {"px", "ev", "ciede2000", each with "…_standard_error"}, "cheaper",
/// "largest_error_of_cheaper"}.
findings::Findings tradeoff_findings(const std::vector<MeasuredScene>& scenes);

}  // namespace lensproof::studies
