#include "experiments/runner/junit.h"

#include <fmt/format.h>

#include "engine/base/markup.h"

namespace lensproof::runner {

std::string junit_xml(const std::string& title, const findings::Findings& found) {
    std::string cases;
    std::size_t failed = 0;
    for (const findings::Check& check : found.checks) {
        const findings::Verdict verdict = check.verdict();
        cases += fmt::format("    <testcase classname=\"{}\" name=\"{}\"", escape_markup(check.group),
                             escape_markup(check.label));
        if (verdict == findings::Verdict::pass) {
            cases += "/>\n";
            continue;
        }
        ++failed;
        cases += fmt::format(">\n      <failure type=\"{}\" message=\"{}\"/>\n    </testcase>\n",
                             findings::verdict_name(verdict),
                             escape_markup(fmt::format("{:g} ± {:g} {}, wanted {}", check.value, check.sigma,
                                                       check.unit, findings::bound_text(check))));
    }
    for (const findings::Failure& failure : found.failures) {
        cases += fmt::format(
            "    <testcase classname=\"studies\" name=\"{}\">\n      <error type=\"{}\" message=\"{}\"/>\n"
            "    </testcase>\n",
            escape_markup(failure.study), failure.is_of_input ? "input" : "machine", escape_markup(failure.message));
    }
    return fmt::format(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites>\n"
        "  <testsuite name=\"{}\" tests=\"{}\" failures=\"{}\" errors=\"{}\">\n{}  </testsuite>\n</testsuites>\n",
        escape_markup(title), found.checks.size() + found.failures.size(), failed, found.failures.size(), cases);
}

}  // namespace lensproof::runner
