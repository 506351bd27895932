#include "engine/scene/chart_file.h"

#include <fmt/format.h>

namespace lensproof {

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

}  // namespace

Chart read_chart(TomlTable& table) {
    Chart chart;
    const std::string kind = table.choice("kind", {"checkerboard", "disc-grid", "flat-field"});
    if (kind == "checkerboard") {
        const GridSize size = read_grid(table, "squares", 3);
        chart.pattern = Checkerboard{size.columns, size.rows, table.number("square_mm", kLength)};
    } else if (kind == "disc-grid") {
        const GridSize size = read_grid(table, "discs", 2);
        const DiscGrid grid{size.columns, size.rows, table.number("pitch_mm", kLength),
                            table.number("diameter_mm", kLength)};
        if (grid.diameter_mm >= grid.pitch_mm) {
            table.fail("diameter_mm",
                       fmt::format("is {}, expected less than pitch_mm, which is {}", grid.diameter_mm, grid.pitch_mm));
        }
        chart.pattern = grid;
    } else {
        chart.pattern = FlatField{};
    }
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

}  // namespace lensproof
