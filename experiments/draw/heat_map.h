// experiments/draw/heat_map.h — a function of two variables as a picture, with the bar that says what its colours mean.
#pragma once
#include <string>
#include <vector>

#include "experiments/draw/colour_map.h"
#include "experiments/draw/svg.h"
#include "experiments/draw/ticks.h"

namespace lensproof::draw {

/// Values on a grid of pixels. What is not finite is masked: shown as paper.
struct HeatMap {
    std::size_t columns = 0;
    std::size_t rows = 0;
    std::vector<double> values{};  // columns * rows: row by row from low y to high y, each from low x to high x
    AxisRange x{};                 // outer edges of the outermost pixels
    AxisRange y{};
    ColourMap colours = ColourMap::sequential;
    AxisScale scale = AxisScale::linear;  // logarithmic: what is below the range has the lowest colour
    AxisRange range{0.0, 1.0};            // what the ends of the colours stand for
    std::string label{};                  // of the colour bar
    std::string unit{};
};

/// Of masked pixels, and of the frame beside the map.
inline constexpr const char* kMaskColour = "#f1f2f3";

/// A range for a diverging map of values like these: symmetric about 0, at least `least` to either side.
AxisRange symmetric_range(const std::vector<double>& values, double least);

/// The map over that box of the page, as a PNG inside the drawing; its pixels stay sharp however far one zooms in.
/// Throws std::runtime_error where the PNG cannot be made.
void draw_heat_map(Svg& svg, const HeatMap& map, const PageBox& box);

/// The bar at the right of a frame, with its numbers and title, and the width that it takes there.
double colour_bar_width(const HeatMap& map, double height);
void draw_colour_bar(Svg& svg, const HeatMap& map, const PageBox& frame);

}  // namespace lensproof::draw
