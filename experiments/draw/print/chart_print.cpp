#include "experiments/draw/print/chart_print.h"

#include <cairo-pdf.h>
#include <cairo-svg.h>
#include <cairo.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "engine/base/input_error.h"
#include "engine/base/overloaded.h"
#include "engine/base/parallel.h"
#include "engine/base/write_file.h"
#include "engine/formats/image/page_png.h"

namespace lensproof::draw {

namespace {

constexpr double kPointsPerMm = 72.0 / 25.4;
constexpr double kMillimetresPerInch = 25.4;
constexpr double kMostPixels = 4e8;
constexpr double kMostSide_px = 32767.0;  // Cairo's own limit
constexpr double kText_mm = 2.6;

using Surface = std::unique_ptr<cairo_surface_t, decltype(&cairo_surface_destroy)>;
using Context = std::unique_ptr<cairo_t, decltype(&cairo_destroy)>;

void check(cairo_status_t status, const std::filesystem::path& file) {
    if (status != CAIRO_STATUS_SUCCESS) {
        throw std::runtime_error(
            fmt::format("{}: cannot be written: {}", file.string(), cairo_status_to_string(status)));
    }
}

void add_path(cairo_t* page, const scene::OutlineShape& shape) {
    std::visit(Overloaded{[&](const scene::OutlinePolygon& polygon) {
                              for (const Vec2d& corner : polygon.corners) {
                                  cairo_line_to(page, corner.x, corner.y);
                              }
                          },
                          [&](const scene::OutlineDisc& disc) {
                              cairo_arc(page, disc.centre.x, disc.centre.y, disc.radius_mm, 0.0,
                                        2.0 * std::numbers::pi);
                          },
                          [&](const scene::OutlineSector& sector) {
                              cairo_move_to(page, 0.0, 0.0);
                              cairo_arc(page, 0.0, 0.0, sector.radius_mm, sector.from_rad, sector.to_rad);
                          }},
               shape.shape);
    cairo_close_path(page);
}

void set_ink(cairo_t* page, bool is_black) {
    const double level = is_black ? 0.0 : 1.0;
    cairo_set_source_rgb(page, level, level, level);
}

/// The chart's shapes, those of one colour that follow each other in one path: between them no seam can show.
void draw_chart(cairo_t* page, const scene::Chart& chart) {
    const scene::Outline shapes = scene::outline(chart);
    for (std::size_t i = 0; i < shapes.size(); ++i) {
        cairo_new_sub_path(page);
        add_path(page, shapes[i]);
        if (i + 1 == shapes.size() || shapes[i + 1].is_black != shapes[i].is_black) {
            set_ink(page, shapes[i].is_black);
            cairo_fill(page);
        }
    }
}

double scale_length_mm(const PrintLayout& layout) {
    const double room = layout.paper.width_mm - 2.0 * layout.margin_mm;
    return room >= 190.0 ? 100.0 : (room >= 110.0 ? 50.0 : 20.0);
}

/// The caption to the left, the check scale to the right: a bar with an end mark and a tick every 10 mm.
void draw_caption(cairo_t* page, const PrintLayout& layout, const std::string& caption) {
    const double length = scale_length_mm(layout);
    const double right = layout.paper.width_mm - layout.margin_mm;
    const double foot = layout.paper.height_mm - layout.margin_mm;
    set_ink(page, true);
    cairo_select_font_face(page, "sans-serif", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
    cairo_set_font_size(page, kText_mm);
    cairo_text_extents_t extents;
    cairo_text_extents(page, caption.c_str(), &extents);
    const double room = right - length - 5.0 - layout.margin_mm;
    cairo_set_font_size(page, kText_mm * std::min(1.0, room / std::max(extents.width, 1.0)));
    cairo_move_to(page, layout.margin_mm, foot - 1.0);
    cairo_show_text(page, caption.c_str());
    cairo_set_font_size(page, kText_mm);
    cairo_move_to(page, right - length, foot - 4.0);
    cairo_show_text(page, fmt::format("{:g} mm: measure it on the print", length).c_str());
    cairo_rectangle(page, right - length, foot - 0.3, length, 0.3);
    for (int tick = 0; tick * 10.0 <= length; ++tick) {
        const double height = tick % 5 == 0 ? 3.0 : 1.5;
        const double x = right - length + tick * 10.0;
        // Inside the bar's ends, so that the whole mark is exactly as long as it says.
        cairo_rectangle(page, std::min(x, right - 0.2), foot - height, 0.2, height);
    }
    cairo_fill(page);
}

/// White, and the caption. `unit`: what a millimetre is in the surface's own units.
void start_page(cairo_t* page, const PrintLayout& layout, const std::string& caption, double unit) {
    cairo_scale(page, unit, unit);
    cairo_set_tolerance(page, 0.01);
    set_ink(page, false);
    cairo_paint(page);
    draw_caption(page, layout, caption);
}

void draw_page(cairo_t* page, const scene::Chart& chart, const PrintLayout& layout, const std::string& caption,
               double unit) {
    start_page(page, layout, caption, unit);
    const Vec2d centre = chart_centre_mm(layout);
    cairo_translate(page, centre.x, centre.y);
    draw_chart(page, chart);
}

void draw_vector(const scene::Chart& chart, const PrintLayout& layout, const std::string& caption, bool is_pdf,
                 const std::filesystem::path& file) {
    const double width = layout.paper.width_mm * kPointsPerMm;
    const double height = layout.paper.height_mm * kPointsPerMm;
    std::string bytes;  // a file of its own the library would close without looking whether all was written
    const cairo_write_func_t keep = [](void* to, const unsigned char* data, unsigned int size) {
        static_cast<std::string*>(to)->append(reinterpret_cast<const char*>(data), size);
        return CAIRO_STATUS_SUCCESS;
    };
    const Surface surface(is_pdf ? cairo_pdf_surface_create_for_stream(keep, &bytes, width, height)
                                 : cairo_svg_surface_create_for_stream(keep, &bytes, width, height),
                          cairo_surface_destroy);
    check(cairo_surface_status(surface.get()), file);
    if (is_pdf) {
        // The same chart is the same bytes, whenever it is written.
        cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_CREATE_DATE, "2000-01-01T00:00:00Z");
        cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_TITLE, caption.c_str());
    }
    const Context page(cairo_create(surface.get()), cairo_destroy);
    draw_page(page.get(), chart, layout, caption, kPointsPerMm);
    check(cairo_status(page.get()), file);
    cairo_surface_finish(surface.get());
    check(cairo_surface_status(surface.get()), file);
    write_file(file, bytes);
}

std::vector<unsigned char> greys_of(cairo_surface_t* surface) {
    const int width = cairo_image_surface_get_width(surface);
    const int height = cairo_image_surface_get_height(surface);
    const auto stride = static_cast<std::ptrdiff_t>(cairo_image_surface_get_stride(surface));
    const unsigned char* data = cairo_image_surface_get_data(surface);
    std::vector<unsigned char> grey;
    grey.reserve(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            grey.push_back(data[y * stride + std::ptrdiff_t{4} * x]);  // any of the three: they are the same
        }
    }
    return grey;
}

/// Black where `is_black` says so of a pixel's middle: the chart that is rendered and measured, to the pixel. (Cairo's
/// own polygons are in 1/256 of a pixel, by which a slanting edge goes to the other side of a middle here and there.)
void sample_chart(std::vector<unsigned char>& grey, int width, int height, const scene::Chart& chart,
                  const PrintLayout& layout) {
    const Vec2d centre = chart_centre_mm(layout);
    const Vec2d size = scene::pattern_size_mm(chart);
    const double pixel_mm = kMillimetresPerInch / layout.dpi;
    parallel_for(height, 0, [&](int y) {
        const double y_mm = (y + 0.5) * pixel_mm - centre.y;
        for (int x = 0; x < width && std::abs(y_mm) <= 0.5 * size.y; ++x) {
            const double x_mm = (x + 0.5) * pixel_mm - centre.x;
            if (std::abs(x_mm) <= 0.5 * size.x && scene::is_black(chart, x_mm, y_mm)) {
                grey[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)] = 0;
            }
        }
    });
}

void draw_png(const scene::Chart& chart, const PrintLayout& layout, const std::string& caption,
              const std::filesystem::path& file) {
    const double unit = layout.dpi / kMillimetresPerInch;
    const double width = std::round(layout.paper.width_mm * unit);
    const double height = std::round(layout.paper.height_mm * unit);
    if (!(width >= 1.0 && height >= 1.0) || width > kMostSide_px || height > kMostSide_px ||
        width * height > kMostPixels) {
        throw InputError(
            fmt::format("--dpi {:g} makes a picture of {:.0f} × {:.0f} pixels: expected at most {:.0f} a "
                        "side and {:.0f} in all",
                        layout.dpi, width, height, kMostSide_px, kMostPixels));
    }
    const Surface surface(
        cairo_image_surface_create(CAIRO_FORMAT_RGB24, static_cast<int>(width), static_cast<int>(height)),
        cairo_surface_destroy);
    check(cairo_surface_status(surface.get()), file);
    {
        const Context page(cairo_create(surface.get()), cairo_destroy);
        cairo_set_antialias(page.get(), CAIRO_ANTIALIAS_NONE);
        start_page(page.get(), layout, caption, unit);
        check(cairo_status(page.get()), file);
    }
    cairo_surface_flush(surface.get());
    std::vector<unsigned char> grey = greys_of(surface.get());
    sample_chart(grey, static_cast<int>(width), static_cast<int>(height), chart, layout);
    write_file(file, formats::encode_page_png(static_cast<int>(width), static_cast<int>(height), grey, layout.dpi));
}

}  // namespace

Paper parse_paper(const std::string& name) {
    static constexpr Paper kSeriesA[] = {{1189, 841}, {841, 594}, {594, 420}, {420, 297}, {297, 210}, {210, 148}};
    if (name.size() == 2 && (name[0] == 'A' || name[0] == 'a') && name[1] >= '0' && name[1] <= '5') {
        return kSeriesA[name[1] - '0'];
    }
    if (name == "letter" || name == "Letter") {
        return {279.4, 215.9};
    }
    if (name == "tabloid" || name == "Tabloid") {
        return {431.8, 279.4};
    }
    const std::size_t cross = name.find('x');
    try {
        std::size_t used_width = 0;
        std::size_t used_height = 0;
        const Paper paper{std::stod(name.substr(0, cross), &used_width),
                          cross == std::string::npos ? 0.0 : std::stod(name.substr(cross + 1), &used_height)};
        const bool is_whole = used_width == cross && used_height == name.size() - cross - 1;
        if (is_whole && paper.width_mm >= 10.0 && paper.height_mm >= 10.0 && paper.width_mm <= 5000.0 &&
            paper.height_mm <= 5000.0) {
            return paper;
        }
    } catch (const std::logic_error&) {  // no number; said below
    }
    throw InputError(
        fmt::format("--paper {}: expected A0 to A5, letter, tabloid, or WIDTHxHEIGHT in mm from 10 to 5000", name));
}

Vec2d chart_centre_mm(const PrintLayout& layout) {
    return {0.5 * layout.paper.width_mm, 0.5 * (layout.paper.height_mm - kCaptionHeight_mm)};
}

void check_fit(const scene::Chart& chart, const PrintLayout& layout) {
    const Vec2d size = scene::pattern_size_mm(chart);
    const Vec2d needed{size.x + 2.0 * layout.margin_mm, size.y + 2.0 * layout.margin_mm + kCaptionHeight_mm};
    if (needed.x > layout.paper.width_mm + 1e-9 || needed.y > layout.paper.height_mm + 1e-9) {
        throw InputError(
            fmt::format("the {} is {:g} × {:g} mm, which with margins of {:g} mm and the caption needs a "
                        "paper of {:g} × {:g} mm: this one has {:g} × {:g}",
                        scene::kind_name(chart), size.x, size.y, layout.margin_mm, needed.x, needed.y,
                        layout.paper.width_mm, layout.paper.height_mm));
    }
}

void print_chart(const scene::Chart& chart, const PrintLayout& layout, const std::string& caption,
                 const std::filesystem::path& file) {
    check_fit(chart, layout);
    const std::string extension = file.extension().string();
    if (extension != ".pdf" && extension != ".svg" && extension != ".png") {
        throw InputError(fmt::format("{}: expected a name that ends in .pdf, .svg or .png", file.string()));
    }
    if (extension == ".png") {
        draw_png(chart, layout, caption, file);
    } else {
        draw_vector(chart, layout, caption, extension == ".pdf", file);
    }
}

}  // namespace lensproof::draw
