#include "experiments/runner/report_index.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "engine/base/file.h"
#include "engine/base/input_error.h"
#include "engine/base/json.h"
#include "engine/base/markup.h"

namespace lensproof::runner {

namespace {

namespace fs = std::filesystem;

constexpr const char* kMark = "<meta name=\"generator\" content=\"lensproof reports\">";

struct Linked {
    std::string folder;
    std::string title;
    std::string verdict;
    std::string summary;
};

std::string text_of(const Json& json) {
    return json.is_text() ? json.text() : "";
}

std::vector<Linked> reports_in(const fs::path& folder) {
    std::vector<Linked> reports;
    std::error_code ignored;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder, ignored)) {
        const fs::path file = entry.path() / "report.json";
        if (!fs::is_regular_file(file) || !fs::is_regular_file(entry.path() / "report.html")) {
            continue;
        }
        try {
            const Json report = Json::parse(read_file(file), file.string());
            reports.push_back({entry.path().filename().string(), text_of(report["title"]), text_of(report["verdict"]),
                               text_of(report["summary"])});
        } catch (const InputError&) {  // NOLINT(bugprone-empty-catch): no report of ours
        }
    }
    std::ranges::sort(reports, {}, &Linked::folder);
    return reports;
}

}  // namespace

bool has_index(const fs::path& folder) {
    const fs::path file = folder / "index.html";
    return fs::is_regular_file(file) && read_file(file).find(kMark) != std::string::npos;
}

std::string index_html(const fs::path& folder) {
    std::string rows;
    for (const Linked& report : reports_in(folder)) {
        rows += fmt::format(
            "<tr><td class=\"{2}\">{2}</td><td><a href=\"{0}/report.html\">{1}</a></td><td>{3}</td></tr>\n",
            escape_markup(report.folder), escape_markup(report.title.empty() ? report.folder : report.title),
            escape_markup(report.verdict), escape_markup(report.summary));
    }
    return fmt::format(
        "<!doctype html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n{}\n<title>lensproof reports</title>\n"
        "<style>body {{ font: 16px/1.5 sans-serif; max-width: 72rem; margin: 2rem auto; padding: 0 1rem; color: #222 }}"
        " td {{ padding: .5rem 1rem .5rem 0; vertical-align: top; border-top: 1px solid #ddd }}"
        " .PASS {{ color: #00735c }} .FAIL {{ color: #b3261e }} .INCONCLUSIVE {{ color: #8a5a00 }}</style>\n"
        "<h1>Reports</h1>\n<table>\n{}</table>\n</html>\n",
        kMark, rows);
}

}  // namespace lensproof::runner
