// experiments/runner/run_index.h — a run's results for other programs, and the page that links a folder's reports.
#pragma once
#include <filesystem>
#include <string>

#include "experiments/findings/findings.h"

namespace lensproof::runner {

/// JUnit's XML: a suite, a case for each check, which fails with its verdict and number where it does not pass, and a
/// case with an error for each study that came to no end.
std::string junit_xml(const std::string& title, const findings::Findings& found);

/// The page index.html that links the reports in the folders of `folder`, with their titles and verdicts.
std::string index_html(const std::filesystem::path& folder);

/// Whether `folder` has such a page, and not another's of that name.
bool has_index(const std::filesystem::path& folder);

}  // namespace lensproof::runner
