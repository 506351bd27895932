// experiments/findings/findings.h — what a study found: what is judged, drawn and written, whatever the study.
#pragma once
#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "calibration/profile/profile.h"
#include "engine/base/json.h"
#include "experiments/draw/frame_map.h"
#include "experiments/findings/verdict.h"

namespace lensproof::findings {

struct Fact {
    std::string label;
    std::string value;
};

/// What a layer of a picture shows: the same frame once more, or a signed difference in false colours.
enum class LayerKind { picture, difference };

/// Something else of a picture's frame, to be laid over it pixel by pixel. Named as a picture is.
struct PictureLayer {
    std::string name;
    std::string label;
    LayerKind kind = LayerKind::picture;
    std::string bytes{};
};

/// A picture or a drawing of a subject.
struct Picture {
    std::string name;  // of its file, "tessar/view-1.png"; SVG or JPEG where it ends in .svg or .jpg, else PNG
    std::string caption;
    Json width{};  // px of what was measured, of which the file may be a smaller copy; of a drawing, its own units
    Json height{};
    std::string bytes{};  // empty: it is named and not shown
    /// Detected points, and measured − model there: x, y, dx, dy in px, as in engine/formats/image/image.h.
    std::optional<std::vector<std::array<double, 4>>> points = std::nullopt;
    std::string label{};  // what it is among its layers
    std::vector<PictureLayer> layers{};
};

/// What a subject's points lie about, for the page to find those behind a place of a curve.
struct PointFrame {
    Vec2d centre_px;
    double half_diagonal_px = 0.0;
    double rms_px = 0.0;  // of a residual's coordinate
};

/// One of the things that a study looks at: a camera, an extreme, a lens, a sweep.
struct Subject {
    std::string id;
    std::string kind;
    std::string label;
    std::vector<Fact> facts{};
    std::optional<std::pair<double, double>> focal_length_px = std::nullopt;  // and its standard error
    std::vector<Picture> pictures{};
    std::optional<PointFrame> points = std::nullopt;  // of the pictures' points
    std::vector<Picture> worst{};                     // drawings of the points that are furthest off
};

/// What a plot's curves run over: their `image_height`, whatever it holds.
enum class PlotOver {
    image_height,  // fractions of the half-diagonal
    azimuth,       // ° from right to down
    residual,      // of a point's coordinate, over its rms
};

/// A curve of a subject.
struct Series {
    std::string label;
    std::string subject;
    std::string style;  // "measured", "reference" or "difference"
    calibration::Curve curve;
    std::optional<double> floor = std::nullopt;  // the method's own error
};

/// Curves in one frame. One without a series is not drawn, but keeps its place among the others.
struct Plot {
    std::string id;
    std::string title;
    std::string subtitle;
    std::string y_label;
    std::string y_unit;
    std::optional<double> limit = std::nullopt;  // a band ± limit
    std::vector<Series> series{};
    PlotOver over = PlotOver::image_height;
};

/// A quantity over the frame of a subject's pictures.
struct Map {
    std::string name;  // of its file
    std::string subject;
    std::string caption;
    draw::FrameMap frame;  // maps of the same label share the range of their colours
};

/// A study that came to no end, and why.
struct Failure {
    std::string study;
    std::string message;
    bool is_of_input = false;  // else of the machine: no memory, no room on the disk
};

/// Subjects that belong together, with what is to be said of them.
struct Chapter {
    std::string title;
    std::string text;
    std::vector<std::string> subjects;  // ids
};

/// What subjects are together where a report's page is not told otherwise (experiments/draw/report/report.h).
inline constexpr const char* kUsualSubjects = "Renders and photos";

struct Findings {
    std::vector<Failure> failures{};
    std::vector<Check> checks{};
    bool counts_checks = false;    // the report's summary says how many of them hold
    std::string subjects_title{};  // what the subjects are together
    std::vector<Subject> subjects{};
    std::vector<Chapter> chapters{};  // subjects that are in none stand behind them
    std::vector<Plot> plots{};
    std::vector<Map> maps{};
    std::vector<std::pair<std::string, Json>> tables{};  // numbers for programs, by their key in report.json
    std::vector<calibration::Profile> profiles{};        // of measured cameras, each named as its subject's id
    std::vector<std::filesystem::path> inputs{};         // files that they depend on
    std::vector<std::string> not_shown{};                // what the findings must not be taken for, in sentences
};

/// Adds `more` to `all`. Plots of the same id become one, with the tighter limit; lists of the same key become one;
/// what is not shown is said once.
void append(Findings& all, Findings more);

/// That of the checks; where a study failed, it is INCONCLUSIVE at best.
Verdict overall(const Findings& found);

}  // namespace lensproof::findings
