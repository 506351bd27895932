#include "experiments/runner/experiment.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <exception>
#include <iterator>
#include <map>
#include <set>

#include "engine/base/input_error.h"
#include "engine/base/text.h"
#include "experiments/studies/cameras/comparisons.h"
#include "experiments/studies/cameras/photos.h"
#include "experiments/studies/cameras/simulations.h"
#include "experiments/studies/edge_diffraction/edge_study.h"
#include "experiments/studies/focus_breathing/breathing_study.h"
#include "experiments/studies/measurement_floor/floor_study.h"
#include "experiments/studies/photographed_lenses/photographed_study.h"
#include "experiments/studies/pupil_passage/passage_study.h"
#include "experiments/studies/stability/stability_study.h"
#include "experiments/studies/stray_light/stray_study.h"
#include "experiments/studies/sweeps/sweep_study.h"
#include "experiments/studies/tradeoff/account_study.h"
#include "experiments/studies/tradeoff/ring_study.h"
#include "experiments/studies/tradeoff/tradeoff_study.h"
#include "experiments/studies/twins/twins_study.h"

namespace lensproof::runner {

namespace {

struct StudyKind {
    const char* tables;  // in an experiment's file
    findings::StudyReader read;
    bool stands_alone = true;  // needs no other study in the file
};

/// Every kind of study, in the order in which they are read and carried out.
constexpr std::array kStudies = {
    StudyKind{"[[simulations]]", studies::read_simulations},
    StudyKind{"[[photos]]", studies::read_photos},
    StudyKind{"[[comparisons]]", studies::read_comparisons, false},
    StudyKind{"[[twins]]", studies::read_twins, false},
    StudyKind{"[stability]", studies::read_stability},
    StudyKind{"[[focus_breathing]]", studies::read_focus_breathing},
    StudyKind{"[[sweeps]]", studies::read_sweeps},
    StudyKind{"[[pupil_passage]]", studies::read_pupil_passage},
    StudyKind{"[[stray_light]]", studies::read_stray_light},
    StudyKind{"[[edge_diffraction]]", studies::read_edge_diffraction},
    StudyKind{"[[tradeoff]]", studies::read_tradeoff},
    StudyKind{"[[planned]]", studies::read_planned},
    StudyKind{"[[analysis_rings]]", studies::read_analysis_rings},
    StudyKind{"[measurement_floor]", studies::read_measurement_floor},
    StudyKind{"[[photographed_lenses]]", studies::read_photographed_lenses},
};

std::set<std::string> study_names(const Experiment& experiment) {
    std::set<std::string> names;
    for (const auto& [table, study] : experiment.studies) {
        names.insert(study.name);
    }
    return names;
}

StatedChapter read_chapter(TomlTable& table, const std::set<std::string>& known) {
    StatedChapter chapter{
        .title = table.text("title"), .text = table.text_or("text", ""), .holds = table.texts("holds")};
    for (const std::string& name : chapter.holds) {
        if (!known.contains(name)) {
            table.fail("holds",
                       fmt::format("names \"{}\", expected studies of this file: {}", name, fmt::join(known, ", ")));
        }
    }
    table.finish();
    return chapter;
}

/// With the subjects that their studies have found; one without is left out.
std::vector<findings::Chapter> chapters_of(const Experiment& experiment,
                                           const std::map<std::string, std::vector<std::string>>& subjects) {
    std::vector<findings::Chapter> chapters;
    for (const StatedChapter& stated : experiment.chapters) {
        findings::Chapter chapter{.title = stated.title, .text = stated.text, .subjects = {}};
        for (const std::string& name : stated.holds) {
            if (const auto found = subjects.find(name); found != subjects.end()) {
                std::ranges::copy(found->second, std::back_inserter(chapter.subjects));
            }
        }
        if (!chapter.subjects.empty()) {
            chapters.push_back(std::move(chapter));
        }
    }
    return chapters;
}

}  // namespace

Experiment read_experiment(const std::filesystem::path& path) {
    findings::ExperimentFile file{.top = TomlTable::read(path)};
    Experiment experiment{
        .file = path, .title = file.top.text("title"), .summary = file.top.text_or("summary", ""), .studies = {}};
    std::vector<std::string> expected;
    for (const StudyKind& kind : kStudies) {
        for (findings::Study& study : kind.read(file)) {
            experiment.studies.emplace_back(kind.tables, std::move(study));
        }
        if (kind.stands_alone) {
            expected.emplace_back(kind.tables);
        }
    }
    for (TomlTable& chapter : file.top.tables("chapters")) {
        experiment.chapters.push_back(read_chapter(chapter, study_names(experiment)));
    }
    file.top.finish();
    if (experiment.studies.empty()) {
        file.top.fail("", fmt::format("holds neither {}", fmt::join(expected, " nor ")));
    }
    return experiment;
}

Experiment with_only(Experiment experiment, const std::vector<std::string>& names) {
    const std::set<std::string> known = study_names(experiment);
    for (const std::string& name : names) {
        if (!known.contains(name)) {
            throw InputError(fmt::format("--only names \"{}\", expected a study of {}: {}", printable(name),
                                         experiment.file.string(), fmt::join(known, ", ")));
        }
    }
    std::erase_if(experiment.studies,
                  [&](const auto& study) { return !findings::is_wanted(names, study.second.name); });
    experiment.only = names;
    return experiment;
}

void expect_steps(const Experiment& experiment, const findings::RunSettings& settings) {
    for (const auto& [table, study] : experiment.studies) {
        if (study.steps) {
            settings.steps.expect(study.steps(settings));
        }
    }
}

findings::Findings run_experiment(const Experiment& experiment, const findings::RunSettings& settings,
                                  const findings::RunProgress& progress) {
    findings::Findings found{.inputs = {experiment.file}};
    std::map<std::string, std::vector<std::string>> subjects;  // of each study
    std::exception_ptr first;
    const auto fail = [&](const std::string& study, const std::string& message, bool is_of_input) {
        found.failures.push_back({.study = study, .message = message, .is_of_input = is_of_input});
        first = first ? first : std::current_exception();
    };
    for (const auto& [table, study] : experiment.studies) {
        try {
            findings::Findings more = study.carry_out(settings, progress, found);
            std::ranges::transform(more.subjects, std::back_inserter(subjects[study.name]), &findings::Subject::id);
            findings::append(found, std::move(more));
        } catch (const InputError& error) {
            fail(study.name, error.what(), true);
        } catch (const std::exception& error) {
            fail(study.name, error.what(), false);
        }
    }
    found.chapters = chapters_of(experiment, subjects);
    if (found.failures.size() < experiment.studies.size() || !first) {
        return found;
    }
    try {
        std::rethrow_exception(first);
    } catch (const InputError& error) {
        const std::string said = error.what();
        const std::string file = experiment.file.string();
        throw InputError(said.starts_with(file) ? said : fmt::format("{}: {}", file, said));
    }
}

}  // namespace lensproof::runner
