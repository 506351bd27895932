// experiments/studies/pupil_passage/passage_study.h — [[pupil_passage]]: how many camera paths leave a lens, as
// findings.
#pragma once
#include <vector>

#include "engine/base/toml.h"
#include "experiments/findings/study.h"
#include "experiments/studies/pupil_passage/measure_passage.h"

namespace lensproof::studies {

/// One of the tables: lens, f_number, published_percent = { whole_element, pupil } (optional). Throws InputError naming
/// file, line and key.
PassageSetting read_passage_setting(TomlTable& table);

/// The settings run one after the other.
std::vector<findings::Study> read_pupil_passage(findings::ExperimentFile& file);

/// Of each setting: what pupil sampling loses of all paths, at most 3 %; of those of any ring, at most 10 %; and, where
/// something is published, that no more is lost than there.
std::vector<findings::Check> passage_checks(const std::vector<Passage>& passages);

/// Each setting a subject, drawn in section with paths from four sensor heights, above over the whole rear element,
/// below over the pupil; with a table "passages":
///     [{"lens", "f_number", "image_circle_mm", "whole_element_percent", "pupil_percent", "pupil_error_percent",
///       "whole_element_rings_percent": […], "pupil_rings_percent": […], "published_percent": {…} or null}]
findings::Findings passage_findings(const std::vector<Passage>& passages);

}  // namespace lensproof::studies
