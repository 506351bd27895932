#include "experiments/runner/experiment.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>

#include "engine/base/input_error.h"
#include "experiments/studies/cameras/comparisons.h"
#include "experiments/studies/cameras/photos.h"
#include "experiments/studies/cameras/simulations.h"
#include "experiments/studies/edge_diffraction/edge_study.h"
#include "experiments/studies/measurement_floor/floor_study.h"
#include "experiments/studies/photographed_lenses/photographed_study.h"
#include "experiments/studies/pupil_passage/passage_study.h"
#include "experiments/studies/stability/stability_study.h"
#include "experiments/studies/stray_light/stray_study.h"
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
    StudyKind{"[[pupil_passage]]", studies::read_pupil_passage},
    StudyKind{"[[stray_light]]", studies::read_stray_light},
    StudyKind{"[[edge_diffraction]]", studies::read_edge_diffraction},
    StudyKind{"[[tradeoff]]", studies::read_tradeoff},
    StudyKind{"[[planned]]", studies::read_planned},
    StudyKind{"[[analysis_rings]]", studies::read_analysis_rings},
    StudyKind{"[measurement_floor]", studies::read_measurement_floor},
    StudyKind{"[[photographed_lenses]]", studies::read_photographed_lenses},
};

}  // namespace

Experiment read_experiment(const std::filesystem::path& path) {
    findings::ExperimentFile file{.top = TomlTable::read(path)};
    Experiment experiment{
        .file = path, .title = file.top.text("title"), .summary = file.top.text_or("summary", ""), .studies = {}};
    std::vector<std::string> expected;
    for (const StudyKind& kind : kStudies) {
        if (findings::Study study = kind.read(file)) {
            experiment.studies.push_back(std::move(study));
        }
        if (kind.stands_alone) {
            expected.emplace_back(kind.tables);
        }
    }
    file.top.finish();
    if (experiment.studies.empty()) {
        file.top.fail("", fmt::format("holds neither {}", fmt::join(expected, " nor ")));
    }
    return experiment;
}

findings::Findings run_experiment(const Experiment& experiment, const findings::RunSettings& settings,
                                  const findings::RunProgress& progress) {
    findings::Findings found{.inputs = {experiment.file}};
    for (const findings::Study& study : experiment.studies) {
        try {
            findings::append(found, study(settings, progress, found));
        } catch (const InputError& error) {
            const std::string said = error.what();
            const std::string file = experiment.file.string();
            throw InputError(said.starts_with(file) ? said : fmt::format("{}: {}", file, said));
        }
    }
    return found;
}

}  // namespace lensproof::runner
