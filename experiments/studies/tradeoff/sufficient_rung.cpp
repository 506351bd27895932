#include "experiments/studies/tradeoff/sufficient_rung.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace lensproof::studies {

Contribution asked_of(const MeasuredRung& rung) {
    if (rung.name == kReferenceRung) {
        return {};
    }
    const FieldError& frame = rung.field.frame;
    return {.px = frame.image_px.value > frame.blur_px.value ? frame.image_px : frame.blur_px,
            .ev = frame.exposure_ev,
            .ciede2000 = rung.picture.ciede2000.bias};
}

SufficientRung sufficient_rung(const std::vector<MeasuredRung>& rungs, const Tolerance& tolerance) {
    const MeasuredRung& reference = *std::ranges::find(rungs, kReferenceRung, &MeasuredRung::name);
    const auto excess = [&](const MeasuredRung& rung) { return over_tolerance(asked_of(rung), tolerance); };
    const MeasuredRung* found = &reference;
    for (const MeasuredRung& rung : rungs) {
        if (rung.not_applicable.empty() && excess(rung) <= 1.0 && rung.cost.seconds < found->cost.seconds) {
            found = &rung;
        }
    }
    std::vector<MeasuredRung> cheaper = rungs;
    std::erase_if(cheaper, [&](const MeasuredRung& rung) {
        return !rung.not_applicable.empty() || rung.cost.seconds >= found->cost.seconds;
    });
    Contribution known = asked_of(*found);
    known.ciede2000.standard_error = std::hypot(known.ciede2000.standard_error, reference.picture.ciede2000.bias.value);
    const auto nearest = std::ranges::min_element(cheaper, {}, excess);
    return {.rung = *found,
            .is_sure = found == &reference || keeps(known, tolerance),
            .speed_up = reference.cost.seconds / found->cost.seconds,
            .cheaper = nearest == cheaper.end() ? std::nullopt : std::optional(*nearest)};
}

std::string largest_error(const MeasuredRung& rung, const Tolerance& tolerance) {
    struct Part {
        Measured error;
        double limit;
        const char* unit;
    };
    const Contribution error = asked_of(rung);
    const FieldError& frame = rung.field.frame;
    const std::array parts = {
        Part{error.px, tolerance.px, frame.image_px.value > frame.blur_px.value ? "px off" : "px of width"},
        Part{error.ev, tolerance.ev, "EV"}, Part{error.ciede2000, tolerance.ciede2000, "CIEDE2000"}};
    const Part& largest =
        *std::ranges::max_element(parts, {}, [](const Part& part) { return part.error.value / part.limit; });
    return fmt::format("{:.3g} ± {:.1g} {}", largest.error.value, largest.error.standard_error, largest.unit);
}

}  // namespace lensproof::studies
