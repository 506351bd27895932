#include "experiments/cli/pixel_rectangles.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <sstream>

#include "engine/base/input_error.h"

namespace lensproof::cli {

calibration::PixelRectangle parse_rectangle(const std::string& option, const std::string& text,
                                            const std::string& expected) {
    std::vector<int> numbers;
    std::istringstream fields(text);
    for (std::string field; std::getline(fields, field, ',');) {
        int value = 0;
        const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
        if (error != std::errc() || end != field.data() + field.size()) {
            break;
        }
        numbers.push_back(value);
    }
    const bool is_rectangle = numbers.size() == 4 && std::count(text.begin(), text.end(), ',') == 3 &&
                              numbers[0] >= 0 && numbers[1] >= 0 && numbers[2] > 0 && numbers[3] > 0;
    if (!is_rectangle) {
        throw InputError(fmt::format("{}: found \"{}\", expected {}", option, text, expected));
    }
    return {numbers[0], numbers[1], numbers[2], numbers[3]};
}

std::vector<calibration::PixelRectangle> parse_edges(const std::vector<std::string>& edges) {
    constexpr const char* kAnyEdges = "auto";
    std::vector<calibration::PixelRectangle> rectangles;
    for (const std::string& edge : edges) {
        if (edge == kAnyEdges) {
            if (edges.size() > 1) {
                throw InputError(
                    fmt::format("--edge: \"{}\" beside others: expected it alone, or rectangles", kAnyEdges));
            }
        } else if (edge == "whole") {
            rectangles.emplace_back();
        } else {
            rectangles.push_back(parse_rectangle("--edge", edge, "x,y,width,height in pixels, whole or auto"));
        }
    }
    return rectangles;
}

}  // namespace lensproof::cli
