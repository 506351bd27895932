// experiments/draw/svg.h — a drawing as SVG text: paths, lines, discs, words and groups, and nothing that a file could
// smuggle in.
#pragma once
#include <cmath>
#include <string>
#include <string_view>
#include <vector>

namespace lensproof::draw {

/// A point of the drawing: x to the right, y down, in px.
struct SvgPoint {
    double x = 0.0;
    double y = 0.0;
};

inline bool is_finite(SvgPoint point) {
    return std::isfinite(point.x) && std::isfinite(point.y);
}

/// A rectangle of the drawing by its upper left corner.
struct PageBox {
    double x = 0.0;
    double y = 0.0;
    double width = 0.0;
    double height = 0.0;
};

/// How a line or an area is painted. Colours are CSS colours that the program itself chooses, never text from a file.
struct SvgStyle {
    std::string fill = "none";
    std::string stroke = "none";
    double width = 1.0;           // of the stroke, px
    bool has_round_ends = false;  // a line of no length is then a disc
    std::string dashes{};         // lengths in px: "12 3 2 3"
    double opacity = 1.0;         // of fill and stroke
    std::string class_name{};     // what the thing is, for who reads or restyles the file
    std::string description{};    // what a viewer shows when the pointer rests on it; any text
};

enum class SvgAnchor { start, middle, end };

struct SvgTextStyle {
    double size = 12.0;  // px
    std::string fill = "#222";
    SvgAnchor anchor = SvgAnchor::start;
    bool bold = false;
    double rotation_deg = 0.0;  // clockwise about the text's position
    std::string class_name{};
};

/// A number as SVG spells it: at most two decimals, a point in every locale, no exponent. What is not finite is 0, and
/// lengths end at ±10⁷, which renderers' single precision still holds.
std::string svg_number(double value);

/// The first `most` characters of UTF-8 text, with an ellipsis in the last one's place where there were more.
std::string shortened(std::string_view text, std::size_t most);

/// The lines of `text` broken at spaces, each at most `most` characters long; what does not fit into `lines` of them is
/// cut off with an ellipsis.
std::vector<std::string> wrapped(std::string_view text, std::size_t most, std::size_t lines);

/// About how wide `text` is drawn, px. SVG leaves the font to the viewer, so this is an estimate: that of a common sans
/// serif's average letter, on the wide side.
double svg_text_width(std::string_view text, double size);

/// A drawing that is built from back to front. Points that are not finite are left out; a path of fewer than two points
/// is not drawn.
class Svg {
  public:
    /// `title` names the drawing for screen readers and viewers; any text.
    explicit Svg(std::string_view title = {});

    void path(const std::vector<SvgPoint>& points, const SvgStyle& style, bool closed = false) {
        paths({points}, style, closed);
    }
    /// Several open or closed paths of one style as one element: a curve with gaps, or the marks of a scatter plot.
    void paths(const std::vector<std::vector<SvgPoint>>& pieces, const SvgStyle& style, bool closed = false);
    void line(SvgPoint from, SvgPoint to, const SvgStyle& style) { path({from, to}, style); }
    void circle(SvgPoint centre, double radius, const SvgStyle& style);
    void rectangle(SvgPoint corner, double width, double height, const SvgStyle& style);
    /// A picture (the bytes of a PNG) that fills the box; its pixels are not smoothed when they are enlarged.
    void picture(const PageBox& box, std::string_view png, std::string_view description = {});
    void text(SvgPoint at, std::string_view words, const SvgTextStyle& style = {});
    void open_group(std::string_view class_name);
    void close_group();
    /// What is drawn till the viewport is closed is cut off at `box`. Its coordinates are the drawing's, until a script
    /// narrows its viewBox.
    void open_viewport(std::string_view class_name, const PageBox& box);
    void close_viewport();

    /// The file, on a white ground of that size.
    [[nodiscard]] std::string document(double width, double height) const;
    /// The same without a ground, as an element of a page that says the rest; `attributes` is markup.
    [[nodiscard]] std::string element(double width, double height, std::string_view attributes) const;

  private:
    void finish_element(std::string_view name, const SvgStyle& style);

    std::string title_;
    std::string body_;
};

}  // namespace lensproof::draw
