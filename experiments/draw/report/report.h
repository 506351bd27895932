// experiments/draw/report/report.h — the comparison report: one HTML file that works offline and asks nothing of
// anyone.
#pragma once
#include <map>
#include <string>

#include "engine/base/json.h"

namespace lensproof::draw {

/// The page for `report`, with the pictures inside it. Without JavaScript it still shows the answer, the table of
/// checks, the curves, the facts, the pictures and the provenance; the script zooms and reads the curves and draws the
/// residuals, whose magnification is the reader's.
///
/// `bytes_by_name` holds the files' bytes under the `name` that a picture in `report` has. A name that is missing
/// leaves a labelled gap; a picture that neither a subject nor a map names is left out. Names in .svg are SVG, in .jpg
/// JPEG.
///
/// Whatever `report` holds is shown as text: no string in it can become markup or script. Any key may be absent or
/// null, and a number that is not finite counts as null; nothing throws but std::bad_alloc. The same arguments give the
/// same bytes.
///
/// The schema, lensproof-report/1 ("?" marks what may be absent or null):
///
///     {"schema": "lensproof-report/1", "title", "summary": "one paragraph that answers the question",
///      "verdict": "PASS" | "FAIL" | "INCONCLUSIVE",
///      "checks": [{"id", "group", "label", "value"?, "sigma"?: one standard error, "unit": "px", "%", "EV", "", …,
///                  "limit", "expect": "at most" | "at least"       value against limit
///                                   | "within"                     |value − target| ≤ limit
///                                   | "differs",                   |value − target| > limit, a negative control
///                  "target"?: 0 where absent, "verdict", "explanation"?,
///                  "subject"?: an id below, for the group's colour,
///                  "floor"?: the method's own error, in the same unit}],
///      "failures"?: [{"study", "message", "exit_status"}],             studies that came to no end
///      "against"?: {"report", "verdicts": [{"check", "before", "now"}],        what changed since an earlier report
///                   "numbers": [{"number", "before", "now"}], "pictures": [{"picture", "change", "rms_percent"}],
///                   "changed_numbers", "compared_numbers"},       of which `numbers` lists the first
///      "subjects_title"?: over the subjects; "Renders and photos" where absent,
///      "subjects": [{"id", "kind": "simulation" | "photos", "label",
///                    "facts"?: [{"label", "value": string or number}], "focal_length_px"?: {"value", "sigma"?},
///                    "pictures"?: [{"name", "caption", "width", "height",   of the picture that was measured, px; the
///                                                                           file may be a smaller copy of it
///                                   "label"?: what it is among its layers,
///                                   "layers"?: [{"name", "label", "kind": "picture" | "difference"}],
///                                                           of the same frame: laid over it, or beside it
///                                   "points"?: [[x, y, dx, dy], …]}],       detected point and measured − model, px
///                    "points"?: {"centre_px": [x, y], "half_diagonal_px", "rms_px"},   what the points lie about
///                    "worst"?: [{"name", "caption"}]}],              drawings of the points that are furthest off
///      "chapters"?: [{"title", "text"?, "subjects": [id, …]}],   subjects that stand together, with their checks;
///                                                                those in none follow
///      "plots"?: [{"id", "title", "subtitle"?, "x_label", "y_label", "x_unit"?, "y_unit"?,
///                 "over"?: "image_height" | "azimuth" | "residual": the subjects' points behind a place can be shown,
///                 "limit"?: draws the band ± limit,
///                 "series": [{"label", "subject"?: an id above, which gives the colour,
///                             "style": "measured" (solid) | "reference" (dashed) | "difference" (solid),
///                             "x": [rising], "y": [null leaves a gap], "lower"?, "upper"?: the 95 % band,
///                             "floor"?: the method's own error, drawn as dotted lines about the curve, or about 0
///                                       for a difference,
///                             "covered_to"?: beyond this x the data ended, and the curve is drawn faded}]}],
///      "maps"?: [{"name", "subject"?, "caption"?}],         drawings over the frame, after the plots
///      "not_shown"?: [sentences],                           what the report must not be taken for
///      "provenance"?: {"program", "version", "commit", "libraries", "inputs": [{"file", "sha256"}],
///                      "settings": {…}, …},
///      "reproduce"?: "lensproof run …"}
///
/// Pixel coordinates are those of engine/formats/image/image.h: the centre of the top-left pixel is (0, 0), y runs
/// down. `provenance` may hold further keys; a list of objects becomes a table, an object a list of its settings.
std::string report_html(const Json& report, const std::map<std::string, std::string>& bytes_by_name);

}  // namespace lensproof::draw
