#include "experiments/draw/svg.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "engine/base/markup.h"

namespace lensproof::draw {

namespace {

std::string attribute(std::string_view name, std::string_view value) {
    return " " + std::string(name) + "=\"" + std::string(value) + "\"";
}

std::string box_attributes(const PageBox& box) {
    return attribute("x", svg_number(box.x)) + attribute("y", svg_number(box.y)) +
           attribute("width", svg_number(box.width)) + attribute("height", svg_number(box.height));
}

/// "M1 2 3 4", with a Z where it is closed; nothing for fewer than two points.
std::string path_data(const std::vector<SvgPoint>& points, bool closed) {
    std::string data;
    std::size_t count = 0;
    for (const SvgPoint& point : points) {
        if (is_finite(point)) {
            data += (count == 0 ? "M" : " ") + svg_number(point.x) + " " + svg_number(point.y);
            ++count;
        }
    }
    return count < 2 ? "" : closed ? data + "Z" : data;
}

}  // namespace

std::string svg_number(double value) {
    constexpr double kLargest = 1e7;
    if (!std::isfinite(value)) {
        return "0";
    }
    std::array<char, 32> buffer{};
    const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), std::clamp(value, -kLargest, kLargest),
                                   std::chars_format::fixed, 2)
                         .ptr;
    std::string digits(buffer.data(), end);
    digits.erase(digits.find_last_not_of('0') + 1);
    if (digits.back() == '.') {
        digits.pop_back();
    }
    return digits == "-0" ? "0" : digits;
}

std::string shortened(std::string_view text, std::size_t most) {
    const std::vector<std::string_view> all = markup_characters(text);
    std::string out;
    const bool fits = all.size() <= most;
    for (std::size_t i = 0; i < (fits ? all.size() : most - 1); ++i) {
        out += all[i];
    }
    return fits ? out : out + "…";
}

std::vector<std::string> wrapped(std::string_view text, std::size_t most, std::size_t lines) {
    std::vector<std::string> broken;
    std::vector<std::string_view> rest = markup_characters(text);
    while (!rest.empty() && broken.size() + 1 < lines && rest.size() > most) {
        const auto limit = rest.begin() + static_cast<std::ptrdiff_t>(most) + 1;
        const auto space = std::find(std::make_reverse_iterator(limit), rest.rend(), " ");
        const bool at_space = space != rest.rend() && space.base() - 1 != rest.begin();
        const auto end = at_space ? space.base() - 1 : limit - 1;
        std::string line;
        std::for_each(rest.begin(), end, [&](std::string_view character) { line += character; });
        broken.push_back(std::move(line));
        rest.erase(rest.begin(), at_space ? end + 1 : end);
    }
    std::string last;
    for (const std::string_view character : rest) {
        last += character;
    }
    broken.push_back(shortened(last, most));
    return broken;
}

double svg_text_width(std::string_view text, double size) {
    constexpr double kAverageLetter = 0.58;
    return kAverageLetter * size * static_cast<double>(markup_characters(text).size());
}

Svg::Svg(std::string_view title) : title_(escape_markup(title)) {}

void Svg::finish_element(std::string_view name, const SvgStyle& style) {
    body_ += attribute("fill", style.fill);
    if (style.stroke != "none") {
        body_ += attribute("stroke", style.stroke) + attribute("stroke-width", svg_number(style.width));
    }
    if (style.has_round_ends) {
        body_ += attribute("stroke-linecap", "round");
    }
    if (!style.dashes.empty()) {
        body_ += attribute("stroke-dasharray", style.dashes);
    }
    if (style.opacity < 1.0) {
        body_ += attribute("opacity", svg_number(style.opacity));
    }
    if (!style.class_name.empty()) {
        body_ += attribute("class", escape_markup(style.class_name));
    }
    body_ += style.description.empty()
                 ? "/>\n"
                 : "><title>" + escape_markup(style.description) + "</title></" + std::string(name) + ">\n";
}

void Svg::paths(const std::vector<std::vector<SvgPoint>>& pieces, const SvgStyle& style, bool closed) {
    std::string data;
    for (const std::vector<SvgPoint>& piece : pieces) {
        data += path_data(piece, closed);
    }
    if (!data.empty()) {
        body_ += "<path" + attribute("d", data);
        finish_element("path", style);
    }
}

void Svg::circle(SvgPoint centre, double radius, const SvgStyle& style) {
    if (is_finite(centre) && radius > 0.0) {
        body_ += "<circle" + attribute("cx", svg_number(centre.x)) + attribute("cy", svg_number(centre.y)) +
                 attribute("r", svg_number(radius));
        finish_element("circle", style);
    }
}

void Svg::rectangle(SvgPoint corner, double width, double height, const SvgStyle& style) {
    if (is_finite(corner) && width > 0.0 && height > 0.0) {
        body_ += "<rect" + box_attributes({corner.x, corner.y, width, height});
        finish_element("rect", style);
    }
}

void Svg::picture(const PageBox& box, std::string_view png, std::string_view description) {
    if (is_finite(SvgPoint{box.x, box.y}) && box.width > 0.0 && box.height > 0.0) {
        body_ += "<image" + box_attributes(box) + attribute("preserveAspectRatio", "none") +
                 attribute("style", "image-rendering:optimizeSpeed;image-rendering:pixelated") +
                 attribute("href", "data:image/png;base64," + base64(png));
        finish_element("image", {.description = std::string(description)});
    }
}

void Svg::text(SvgPoint at, std::string_view words, const SvgTextStyle& style) {
    if (!is_finite(at)) {
        return;
    }
    body_ += "<text" + attribute("x", svg_number(at.x)) + attribute("y", svg_number(at.y)) +
             attribute("font-size", svg_number(style.size)) + attribute("fill", style.fill);
    if (style.anchor != SvgAnchor::start) {
        body_ += attribute("text-anchor", style.anchor == SvgAnchor::middle ? "middle" : "end");
    }
    if (style.bold) {
        body_ += attribute("font-weight", "600");
    }
    if (style.rotation_deg != 0.0) {
        body_ += attribute("transform", "rotate(" + svg_number(style.rotation_deg) + " " + svg_number(at.x) + " " +
                                            svg_number(at.y) + ")");
    }
    if (!style.class_name.empty()) {
        body_ += attribute("class", escape_markup(style.class_name));
    }
    body_ += ">" + escape_markup(words) + "</text>\n";
}

void Svg::open_group(std::string_view class_name) {
    body_ += "<g" + attribute("class", escape_markup(class_name)) + ">\n";
}

void Svg::close_group() {
    body_ += "</g>\n";
}

void Svg::open_viewport(std::string_view class_name, const PageBox& box) {
    body_ += "<svg" + attribute("class", escape_markup(class_name)) + box_attributes(box) +
             attribute("viewBox", svg_number(box.x) + " " + svg_number(box.y) + " " + svg_number(box.width) + " " +
                                      svg_number(box.height)) +
             attribute("preserveAspectRatio", "none") + ">\n";
}

void Svg::close_viewport() {
    body_ += "</svg>\n";
}

std::string Svg::element(double width, double height, std::string_view attributes) const {
    const std::string w = svg_number(width);
    const std::string h = svg_number(height);
    return "<svg" + attribute("width", w) + attribute("height", h) + attribute("viewBox", "0 0 " + w + " " + h) + " " +
           std::string(attributes) + ">\n" + body_ + "</svg>\n";
}

std::string Svg::document(double width, double height) const {
    const std::string w = svg_number(width);
    const std::string h = svg_number(height);
    return "<svg xmlns=\"http://www.w3.org/2000/svg\"" + attribute("width", w) + attribute("height", h) +
           attribute("viewBox", "0 0 " + w + " " + h) + attribute("role", "img") +
           attribute("font-family", "Helvetica, Arial, 'Liberation Sans', 'DejaVu Sans', sans-serif") +
           attribute("stroke-linejoin", "round") + attribute("stroke-linecap", "butt") + ">\n<title>" + title_ +
           "</title>\n" + "<rect" + attribute("width", w) + attribute("height", h) + " fill=\"#fff\"/>\n" + body_ +
           "</svg>\n";
}

}  // namespace lensproof::draw
