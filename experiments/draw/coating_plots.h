// experiments/draw/coating_plots.h — reflectance of a coating against wavelength and against angle.
#pragma once
#include <string>

#include "engine/analysis/coating_curves.h"
#include "experiments/draw/analysis_plots.h"

namespace lensproof::draw {

// `heading.lens` names the coating, `heading.conditions` says on which glass.

/// Unpolarised light, a curve an angle; `bare`: the same of the glass alone at normal incidence.
std::string reflectance_spectrum_svg(const PlotHeading& heading, const analysis::CoatingCurves& curves,
                                     const analysis::CoatingCurves& bare);

/// A curve a wavelength and polarisation, on a logarithmic scale.
std::string reflectance_by_angle_svg(const PlotHeading& heading, const analysis::CoatingCurves& curves);

}  // namespace lensproof::draw
