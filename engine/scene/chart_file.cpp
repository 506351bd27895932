#include "engine/scene/chart_file.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <utility>

#include "engine/scene/aruco.h"

namespace lensproof::scene {

namespace {

constexpr Bounds kReflectance{.min = 0.0, .max = 1.0};
constexpr Bounds kLength{.min = 0.0, .max = 1e9, .min_excluded = true};

GridSize read_grid(TomlTable& table, const std::string& key, int least) {
    const std::vector<double> counts = table.numbers(key, 2, {.min = static_cast<double>(least), .max = 1000.0});
    const GridSize size{static_cast<int>(counts[0]), static_cast<int>(counts[1])};
    if (size.columns != counts[0] || size.rows != counts[1]) {
        table.fail(key, "expected whole numbers of columns and rows");
    }
    return size;
}

/// A length that is smaller than another key's.
double read_smaller(TomlTable& table, const std::string& key, const std::string& than, double limit_mm) {
    const double length_mm = table.number(key, kLength);
    if (!(length_mm < limit_mm)) {
        table.fail(key, fmt::format("is {}, expected less than {}, which is {}", length_mm, than, limit_mm));
    }
    return length_mm;
}

Checkerboard read_checkerboard(TomlTable& table) {
    const GridSize size = read_grid(table, "squares", 3);
    return {size.columns, size.rows, table.number("square_mm", kLength)};
}

DiscGrid read_disc_grid(TomlTable& table) {
    const GridSize size = read_grid(table, "discs", 2);
    const double pitch_mm = table.number("pitch_mm", kLength);
    return {size.columns, size.rows, pitch_mm, read_smaller(table, "diameter_mm", "pitch_mm", pitch_mm)};
}

CharucoBoard read_charuco(TomlTable& table) {
    const GridSize size = read_grid(table, "squares", 2);
    CharucoBoard board{.columns = size.columns, .rows = size.rows, .square_mm = table.number("square_mm", kLength)};
    board.marker_mm = read_smaller(table, "marker_mm", "square_mm", board.square_mm);
    ArucoDictionary dictionary = aruco_dictionary(table.choice("dictionary", known_aruco_dictionaries()));
    const auto needed = static_cast<std::size_t>(size.columns) * size.rows / 2;
    if (needed > dictionary.markers.size()) {
        table.fail("squares", fmt::format("has {} white squares, more than the {} markers of {}", needed,
                                          dictionary.markers.size(), dictionary.name));
    }
    board.cells = dictionary.cells;
    board.markers = std::move(dictionary.markers);
    return board;
}

SiemensStar read_siemens_star(TomlTable& table) {
    const SiemensStar star{table.integer("sectors", 2, 10000), table.number("radius_mm", kLength)};
    if (star.sectors % 2 != 0) {
        table.fail("sectors", fmt::format("is {}, expected an even number: black and white ones", star.sectors));
    }
    return star;
}

SlantedEdges read_slanted_edges(TomlTable& table) {
    const GridSize size = read_grid(table, "squares", 1);
    SlantedEdges edges{.columns = size.columns, .rows = size.rows, .pitch_mm = table.number("pitch_mm", kLength)};
    edges.angle_deg = table.number_or("angle_deg", edges.angle_deg, {.min = -45.0, .max = 45.0});
    const double angle = std::abs(edges.angle_deg) * std::numbers::pi / 180.0;
    const double largest = edges.pitch_mm / (std::cos(angle) + std::sin(angle));
    edges.square_mm = read_smaller(table, "square_mm", "what of pitch_mm a turned square may have", largest);
    return edges;
}

PointGrid read_point_grid(TomlTable& table) {
    const GridSize size = read_grid(table, "points", 1);
    const double pitch_mm = table.number("pitch_mm", kLength);
    return {size.columns, size.rows, pitch_mm, read_smaller(table, "dot_mm", "pitch_mm", pitch_mm)};
}

AstigmatismCrosses read_crosses(TomlTable& table) {
    const GridSize size = read_grid(table, "crosses", 1);
    const double pitch_mm = table.number("pitch_mm", kLength);
    const double length_mm =
        read_smaller(table, "length_mm", "what of pitch_mm a turned line may have", pitch_mm / std::numbers::sqrt2);
    return {size.columns, size.rows, pitch_mm, length_mm, read_smaller(table, "line_mm", "length_mm", length_mm)};
}

StraightLines read_straight_lines(TomlTable& table) {
    const GridSize size = read_grid(table, "lines", 2);
    const double pitch_mm = table.number("pitch_mm", kLength);
    return {size.columns, size.rows, pitch_mm, read_smaller(table, "line_mm", "pitch_mm", pitch_mm)};
}

ChartPattern read_pattern(TomlTable& table) {
    const std::string kind =
        table.choice("kind", {"checkerboard", "disc-grid", "flat-field", "charuco", "siemens-star", "slanted-edges",
                              "point-grid", "astigmatism-crosses", "colour-checker", "straight-lines"});
    if (kind == "checkerboard") {
        return read_checkerboard(table);
    }
    if (kind == "disc-grid") {
        return read_disc_grid(table);
    }
    if (kind == "charuco") {
        return read_charuco(table);
    }
    if (kind == "siemens-star") {
        return read_siemens_star(table);
    }
    if (kind == "slanted-edges") {
        return read_slanted_edges(table);
    }
    if (kind == "point-grid") {
        return read_point_grid(table);
    }
    if (kind == "astigmatism-crosses") {
        return read_crosses(table);
    }
    if (kind == "straight-lines") {
        return read_straight_lines(table);
    }
    if (kind == "colour-checker") {
        return ColourChecker{table.number("patch_mm", kLength), table.number("gap_mm", kLength)};
    }
    return FlatField{};
}

}  // namespace

Chart read_chart(TomlTable& table) {
    Chart chart{.pattern = read_pattern(table)};
    chart.white_reflectance = table.number_or("white_reflectance", chart.white_reflectance, kReflectance);
    chart.black_reflectance = table.number_or("black_reflectance", chart.black_reflectance, kReflectance);
    table.finish();
    return chart;
}

Chart read_chart_file(const std::filesystem::path& file) {
    TomlTable top = TomlTable::read(file);
    TomlTable table = top.table("chart");
    return read_chart(table);
}

Placement read_placement(TomlTable& table) {
    Placement placement;
    placement.distance_mm = table.number("distance_mm", kLength);
    if (table.has("towards_deg")) {
        const std::vector<double> towards = table.numbers("towards_deg", 2, {.min = -180.0, .max = 180.0});
        placement.towards_right_deg = towards[0];
        placement.towards_down_deg = towards[1];
    }
    if (table.has("tilt_deg")) {
        const std::vector<double> tilt = table.numbers("tilt_deg", 3, {.min = -180.0, .max = 180.0});
        placement.tilt_deg = {tilt[0], tilt[1], tilt[2]};
    }
    table.finish();
    return placement;
}

}  // namespace lensproof::scene
