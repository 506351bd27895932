// experiments/draw/plot_words.h — titles, names and looks that the plots of an analysis share.
#pragma once
#include <string>
#include <vector>

#include "experiments/draw/analysis_plots.h"
#include "experiments/draw/chart.h"

namespace lensproof::draw {

/// "Tessar · ray fans".
std::string plot_title(const PlotHeading& heading, const std::string& what);

/// "12.5°"
std::string field_text(double field_deg);

/// "587.6 nm"
std::string wavelength_text(double wavelength_nm);

/// A thin line through zero.
ReferenceLine zero_line(ReferenceDirection direction);

/// A curve of that wavelength's colour.
ChartCurve wavelength_curve(const analysis::WavelengthCurve& curve);

/// An entry of the legend that no curve has: what solid and dashed mean.
ChartCurve legend_only(const std::string& label, CurveLine line);

/// By rising x, so that a line goes once along the field whatever order the fields came in.
std::vector<Vec2d> in_order(std::vector<Vec2d> points);

/// The colour of the `index`th of `count` fields or frequencies: as different as possible for a few, from dark to light
/// for many.
std::string ordered_colour(std::size_t index, std::size_t count);

}  // namespace lensproof::draw
