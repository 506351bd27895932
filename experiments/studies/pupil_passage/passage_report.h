// experiments/studies/pupil_passage/passage_report.h — passage through lenses as checks, as drawings, and as the
// report's JSON.
#pragma once
#include <map>
#include <string>
#include <vector>

#include "engine/base/json.h"
#include "experiments/runner/run_experiment.h"
#include "experiments/studies/pupil_passage/measure_passage.h"

namespace lensproof::studies {

/// The experiment's settings, one after the other.
std::vector<Passage> run_pupil_passage(const runner::Experiment& experiment, const runner::RunSettings& settings,
                                       const runner::RunProgress& progress);

/// Of each setting: what pupil sampling loses of all paths, at most 3 %; of those of any ring, at most 10 %; and, where
/// something is published, that no more is lost than there.
std::vector<runner::Check> passage_checks(const std::vector<Passage>& passages);

/// Drawings by the names that the JSON uses: of each setting the section with paths from four sensor heights, above
/// over the whole rear element, below over the pupil; and the passage of each ring. SVG.
std::map<std::string, std::string> passage_drawings(const std::vector<Passage>& passages);

/// In the schema of experiments/draw/report/report.h, each setting a subject, with "passages" besides:
///     [{"lens", "f_number", "image_circle_mm", "whole_element_percent", "pupil_percent", "pupil_error_percent",
///       "whole_element_rings_percent": […], "pupil_rings_percent": […], "published_percent": {…} or null}]
Json passage_report_json(const runner::Experiment& experiment, const std::vector<Passage>& passages,
                         const runner::RunSettings& settings);

}  // namespace lensproof::studies
