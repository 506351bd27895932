// experiments/cli/findings_text.h — findings as a person reads them: a line each, and what many surfaces share once.
#pragma once
#include <string>
#include <vector>

#include "engine/optics/finding.h"

namespace lensproof::cli {

/// "  warning surface 3  glass-unknown: …", a line each, in the order given. Findings of one code and severity that say
/// the same of several surfaces are one line, where the first of them stands, with their count and their surfaces at
/// its end; the lines of a file that they speak of ("line 7, surface 2 of the file: ") do not keep them apart.
std::string findings_text(const std::vector<optics::Finding>& findings);

}  // namespace lensproof::cli
