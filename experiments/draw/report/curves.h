// experiments/draw/report/curves.h — a report's plots as figures of its page.
//
// They are drawn here, by the hand that draws every other chart, and not by the page's script: a reader has them
// without a script, in print and in a mail's preview, and what a chart can show the report can, without a line of
// JavaScript. The script zooms, points and hides.
#pragma once
#include <string>

#include "engine/base/json.h"

namespace lensproof::draw {

/// A <figure> for each plot of `report` (the schema is report.h's): title, chart, legend and a table of values; or the
/// words that there is none. The chart stands there twice, for a wide and for a narrow column, and the page's style
/// shows the one that fits, since text has to keep its size. For the script: a figure says its place in the report's
/// list and the ranges of its axes, a chart its frame (px: x, y, width, height); the data stand in a viewport "data",
/// those of the i-th series in groups "series-i".
std::string curves_html(const Json& report);

}  // namespace lensproof::draw
