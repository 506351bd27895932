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
    move_to(all.checks, more.checks);
    all.counts_checks |= more.counts_checks;
    if (all.subjects_title.find(more.subjects_title) == std::string::npos) {
        all.subjects_title += (all.subjects_title.empty() ? "" : ", ") + more.subjects_title;
    }
    move_to(all.subjects, more.subjects);
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
    move_to(all.tables, more.tables);
    move_to(all.profiles, more.profiles);
    move_to(all.inputs, more.inputs);
}

}  // namespace lensproof::findings
