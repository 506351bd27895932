// experiments/studies/edge_diffraction/edge_study.h — [[edge_diffraction]]: light diffracted by rays against the wave
// theory, as findings.
#pragma once
#include <utility>
#include <vector>

#include "experiments/findings/study.h"
#include "experiments/studies/edge_diffraction/measure_edges.h"

namespace lensproof::studies {

/// Tables with `lens`, lists of `f_numbers` and `blades` (0: a circle), of which every pair is a setting, and optional
/// `curvature` and `paths`.
std::vector<findings::Study> read_edge_diffraction(findings::ExperimentFile& file);

using MeasuredEdges = std::vector<std::pair<EdgeSetting, EdgeDiffraction>>;

/// Of each setting: octaves from 5 to 100 λN within 10 % of the wave's, the profile's logarithmic slope within 5 %, the
/// light from 5 λN on within 5 %, and, of straight blades, streaks within 0.2° of the edges' normals.
std::vector<findings::Check> edge_checks(const MeasuredEdges& measured);

/// A subject for each lens and number of blades, with both maps and both profiles, and the table "edge_diffraction":
///     [{"lens", "f_number", "blades", "curvature", "octaves_airy": [5, …], "rays": […], "wave": […], "rays_slope",
///       "wave_slope", "energy_ratio", "energy_ratio_standard_error", "streaks_deg": […]}]
/// with irradiances over that of the light, and lengths in λN.
findings::Findings edge_findings(const MeasuredEdges& measured);

}  // namespace lensproof::studies
