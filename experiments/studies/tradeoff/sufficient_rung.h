// experiments/studies/tradeoff/sufficient_rung.h — the cheapest model of a lens that a picture bears.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "engine/base/json.h"
#include "experiments/studies/tradeoff/plan.h"
#include "experiments/studies/tradeoff/rungs.h"

namespace lensproof::studies {

/// What a tolerance asks of a model: px is how far the image of a point is off or how much its width is, whichever is
/// more. The reference's errors are none, whatever its pictures' noise.
Contribution asked_of(const MeasuredRung& rung);

/// Of models of a lens: the cheapest whose errors keep the tolerance, the reference at the latest, and of the cheaper
/// ones that which exceeds it by the smallest factor.
struct SufficientRung {
    MeasuredRung rung;
    /// It keeps the tolerance with two standard errors. To CIEDE2000's is added what the reference seems to differ by
    /// from itself with other seeds: blocks of a picture do not show noise that is the same all over it.
    bool is_sure = false;
    double speed_up = 1.0;  // the reference's time to the wanted noise, over the rung's
    std::optional<MeasuredRung> cheaper;
};
SufficientRung sufficient_rung(const std::vector<MeasuredRung>& rungs, const Tolerance& tolerance);

/// That of a rung's errors which is the most of what may be: "0.62 ± 0.01 px of width", "0.28 ± 0.003 EV", "2.6 ± 0.3
/// CIEDE2000".
std::string largest_error(const MeasuredRung& rung, const Tolerance& tolerance);

}  // namespace lensproof::studies
