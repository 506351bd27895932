// tests/cli/trace_table.h — the tables that `trace` reads and writes.
#pragma once
#include <gtest/gtest.h>

#include <array>
#include <charconv>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

namespace lensproof {

using Triple = std::array<double, 3>;

inline constexpr const char* kRayHeader = "id,x_mm,y_mm,z_mm,dx,dy,dz,wavelength_nm\n";

inline constexpr const char* kAxialRay = "a,0,1,-10,0,0,1,587.5618\n";

/// The cells of a table's lines.
inline std::vector<std::vector<std::string>> cells_of(const std::string& csv) {
    std::vector<std::vector<std::string>> rows;
    std::istringstream lines(csv);
    for (std::string line; std::getline(lines, line);) {
        std::istringstream stream(line);
        rows.emplace_back();
        for (std::string cell; std::getline(stream, cell, ',');) {
            rows.back().push_back(cell);
        }
    }
    return rows;
}

/// One row of the command's answer.
struct TraceRow {
    std::string surface;
    Triple point{};
    Triple direction{};
    double optical_path = 0.0;
    std::string status;
};

using TraceRows = std::map<std::string, std::vector<TraceRow>>;  // by the ray's id

/// Three numbers of a list, from the one at `first`.
inline Triple triple(const nlohmann::json& list, std::size_t first = 0) {
    return {list[first], list[first + 1], list[first + 2]};
}

/// The shortest text that reads back as the same double.
inline std::string exact(double value) {
    std::array<char, 32> text{};
    return {text.data(), std::to_chars(text.data(), text.data() + text.size(), value).ptr};
}

/// A ray's line, the direction as given: reading makes it a unit vector.
inline std::string ray_line(const std::string& id, const Triple& origin, const Triple& direction,
                            double wavelength_nm) {
    std::string line = id;
    for (const Triple& list : {origin, direction}) {
        for (const double value : list) {
            line += "," + exact(value);
        }
    }
    return line + "," + exact(wavelength_nm) + "\n";
}

inline TraceRows read_trace_rows(const std::string& csv) {
    TraceRows rows;
    EXPECT_TRUE(csv.starts_with("id,surface,x_mm,y_mm,z_mm,dx,dy,dz,optical_path_mm,transmittance,status\n")) << csv;
    const std::vector<std::vector<std::string>> table = cells_of(csv);
    for (std::size_t row = 1; row < table.size(); ++row) {
        const std::vector<std::string>& cells = table[row];
        if (cells.size() != 11) {
            ADD_FAILURE() << cells.size() << " cells";
            continue;
        }
        const auto number = [&](std::size_t i) { return std::stod(cells[i]); };
        rows[cells[0]].push_back({.surface = cells[1],
                                  .point = {number(2), number(3), number(4)},
                                  .direction = {number(5), number(6), number(7)},
                                  .optical_path = number(8),
                                  .status = cells[10]});
    }
    return rows;
}

inline void expect_near(const Triple& found, const Triple& expected, double tolerance) {
    for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_NEAR(found[i], expected[i], tolerance);
    }
}

}  // namespace lensproof
