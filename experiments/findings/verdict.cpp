#include "experiments/findings/verdict.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "calibration/statistics/curve.h"

namespace lensproof::findings {

std::string verdict_name(Verdict verdict) {
    constexpr std::array kNames = {"PASS", "FAIL", "INCONCLUSIVE"};
    return kNames.at(static_cast<std::size_t>(verdict));
}

std::string expectation_name(Expectation expectation) {
    constexpr std::array kNames = {"at most", "within", "differs", "at least"};
    return kNames.at(static_cast<std::size_t>(expectation));
}

Verdict Check::verdict() const {
    if (!std::isfinite(value) || !std::isfinite(sigma) || !std::isfinite(limit)) {
        return Verdict::inconclusive;
    }
    const double deviation = expectation == Expectation::within ? std::abs(value - target) : value;
    const bool surely_below = deviation + calibration::k95 * sigma <= limit;
    const bool surely_above = deviation - calibration::k95 * sigma > limit;
    if (!surely_below && !surely_above) {
        return Verdict::inconclusive;
    }
    const bool wanted_below = expectation == Expectation::at_most || expectation == Expectation::within;
    return surely_below == wanted_below ? Verdict::pass : Verdict::fail;
}

bool Check::is_below_floor() const {
    const double deviation = expectation == Expectation::within ? value - target : value;
    return floor && std::abs(deviation) <= *floor;
}

std::string bound_text(const Check& check) {
    switch (check.expectation) {
        case Expectation::within:
            return fmt::format("{:g} ± {:g}", check.target, check.limit);
        case Expectation::differs:
            return fmt::format("> {:g}", check.limit);
        case Expectation::at_least:
            return fmt::format("≥ {:g}", check.limit);
        case Expectation::at_most:
            break;
    }
    return fmt::format("≤ {:g}", check.limit);
}

Verdict overall(const std::vector<Check>& checks) {
    Verdict worst = Verdict::pass;
    for (const Check& check : checks) {
        const Verdict verdict = check.verdict();
        if (verdict == Verdict::fail) {
            return Verdict::fail;
        }
        if (verdict == Verdict::inconclusive) {
            worst = Verdict::inconclusive;
        }
    }
    return worst;
}

}  // namespace lensproof::findings
