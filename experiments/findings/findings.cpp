#include "experiments/findings/findings.h"

#include <algorithm>
#include <iterator>

namespace lensproof::findings {

namespace {

template <class T>
void move_to(std::vector<T>& all, std::vector<T>& more) {
    std::ranges::move(more, std::back_inserter(all));
}

}  // namespace

void append(Findings& all, Findings more) {
    move_to(all.failures, more.failures);
    move_to(all.checks, more.checks);
    all.counts_checks |= more.counts_checks;
    if (all.subjects_title.find(more.subjects_title) == std::string::npos) {
        all.subjects_title += (all.subjects_title.empty() ? "" : ", ") + more.subjects_title;
    }
    move_to(all.subjects, more.subjects);
    move_to(all.chapters, more.chapters);
    for (Plot& plot : more.plots) {
        const auto known = std::ranges::find(all.plots, plot.id, &Plot::id);
        if (known == all.plots.end()) {
            all.plots.push_back(std::move(plot));
            continue;
        }
        if (plot.limit) {
            known->limit = std::min(known->limit.value_or(*plot.limit), *plot.limit);
        }
        move_to(known->series, plot.series);
    }
    move_to(all.maps, more.maps);
    for (auto& [key, table] : more.tables) {
        const auto known = std::ranges::find(all.tables, key, [](const auto& named) { return named.first; });
        if (known == all.tables.end() || !known->second.is_list() || !table.is_list()) {
            all.tables.emplace_back(key, std::move(table));
            continue;
        }
        for (const Json& row : table) {
            known->second.push_back(row);
        }
    }
    move_to(all.profiles, more.profiles);
    move_to(all.inputs, more.inputs);
    for (std::string& sentence : more.not_shown) {
        if (std::ranges::find(all.not_shown, sentence) == all.not_shown.end()) {
            all.not_shown.push_back(std::move(sentence));
        }
    }
}

Verdict overall(const Findings& found) {
    const Verdict verdict = overall(found.checks);
    return verdict == Verdict::pass && !found.failures.empty() ? Verdict::inconclusive : verdict;
}

}  // namespace lensproof::findings
