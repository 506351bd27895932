// experiments/runner/junit.h — a run's checks for programs that read JUnit's XML.
#pragma once
#include <string>

#include "experiments/findings/findings.h"

namespace lensproof::runner {

/// A suite with a case for each check, which fails with its verdict and number where it does not pass, and a case with
/// an error for each study that came to no end.
std::string junit_xml(const std::string& title, const findings::Findings& found);

}  // namespace lensproof::runner
