// experiments/findings/verdict.h — whether a number that is known with an uncertainty keeps its limit.
#pragma once
#include <optional>
#include <string>
#include <vector>

namespace lensproof::findings {

enum class Verdict { pass, fail, inconclusive };

/// "PASS", "FAIL" or "INCONCLUSIVE".
std::string verdict_name(Verdict verdict);

/// What a value is held against.
enum class Expectation {
    at_most,  // value ≤ limit
    within,   // |value − target| ≤ limit
    differs,  // value > limit: a negative control, for things that must be told apart
    at_least  // value ≥ limit
};

std::string expectation_name(Expectation expectation);

struct Check {
    std::string id;
    std::string group;
    std::string subject;  // whose it is, for colours; may be empty
    std::string label;
    double value = 0.0;
    double sigma = 0.0;  // one standard error
    std::string unit;
    double limit = 0.0;
    Expectation expectation = Expectation::at_most;
    double target = 0.0;
    std::string explanation;
    /// The method's own error in this number, from the self-tests of what it was measured in; none: not known.
    std::optional<double> floor = std::nullopt;

    /// PASS where the 95 % interval value ± 1.96 σ keeps the limit as a whole, FAIL where it breaks it as a whole,
    /// INCONCLUSIVE where the limit lies inside it, or a number is not finite.
    [[nodiscard]] Verdict verdict() const;

    /// Whether the difference that is judged (the value, or its distance from the target) is no larger than `floor`.
    [[nodiscard]] bool is_below_floor() const;
};

/// What the check's value has to be, in words: "≤ 0.5", "533.3 ± 2.1".
std::string bound_text(const Check& check);

/// FAIL where any check fails, else INCONCLUSIVE where any is, else PASS. Without checks: PASS.
Verdict overall(const std::vector<Check>& checks);

}  // namespace lensproof::findings
