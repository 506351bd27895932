#include "experiments/runner/verdict.h"

#include <algorithm>
#include <cmath>

#include "calibration/statistics/curve.h"

namespace lensproof::runner {

std::string verdict_name(Verdict verdict) {
    switch (verdict) {
        case Verdict::pass:
            return "PASS";
        case Verdict::fail:
            return "FAIL";
        case Verdict::inconclusive:
            return "INCONCLUSIVE";
    }
    return "INCONCLUSIVE";
}

std::string expectation_name(Expectation expectation) {
    switch (expectation) {
        case Expectation::at_most:
            return "at most";
        case Expectation::within:
            return "within";
        case Expectation::differs:
            return "differs";
    }
    return "at most";
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
    const bool wanted_below = expectation != Expectation::differs;
    return surely_below == wanted_below ? Verdict::pass : Verdict::fail;
}

bool Check::is_below_floor() const {
    const double deviation = expectation == Expectation::within ? value - target : value;
    return floor && std::abs(deviation) <= *floor;
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

}  // namespace lensproof::runner
