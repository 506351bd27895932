// experiments/draw/print/chart_print.h — a chart as a page to print, and as the file that describes it.
#pragma once
#include <filesystem>
#include <string>

#include "engine/scene/chart/chart.h"

namespace lensproof::draw {

struct Paper {
    double width_mm = 297.0;
    double height_mm = 210.0;
};

/// "A0" … "A5", "letter", "tabloid" (the longer side across) or "WIDTHxHEIGHT" in mm. Throws InputError for another.
Paper parse_paper(const std::string& name);

/// What is white around the chart at least: `margin_mm` at the paper's sides, and below the chart room for the caption.
struct PrintLayout {
    Paper paper;
    double margin_mm = 10.0;
    double dpi = 600.0;  // of a PNG
};

/// Height of the caption's strip at the foot of the page, margin apart, mm.
constexpr double kCaptionHeight_mm = 12.0;

/// Throws InputError where the chart does not fit on the paper, saying how large a paper it needs.
void check_fit(const scene::Chart& chart, const PrintLayout& layout);

/// Where the chart's centre lies on the page, mm from its top left: the middle of what the caption leaves.
Vec2d chart_centre_mm(const PrintLayout& layout);

/// Draws the chart in black on white with a caption below (`caption`, and a scale of 100 mm to check the print by, or
/// of 50 or 20 where the paper is small): .pdf and .svg in exact mm, .png by `dpi`, a pixel black or white by what its
/// middle shows of the chart. Throws InputError for another extension, a chart that does not fit and a picture of more
/// than 400 megapixels.
void print_chart(const scene::Chart& chart, const PrintLayout& layout, const std::string& caption,
                 const std::filesystem::path& file);

}  // namespace lensproof::draw
