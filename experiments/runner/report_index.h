// experiments/runner/report_index.h — the page that links a folder's reports.
#pragma once
#include <filesystem>
#include <string>

namespace lensproof::runner {

/// The page index.html that links the reports in the folders of `folder`, with their titles and verdicts.
std::string index_html(const std::filesystem::path& folder);

/// Whether `folder` has such a page, and not another's of that name.
bool has_index(const std::filesystem::path& folder);

}  // namespace lensproof::runner
