// tests/cli/trace_table.h — the tables that `trace` reads and writes.
#pragma once
#include <gtest/gtest.h>

#include <array>
#include <charconv>
#include <map>
#include <sstream>
#include <string>
#include <vector>

namespace lensproof {

using Triple = std::array<double, 3>;

inline constexpr const char* kRayHeader = "id,x_mm,y_mm,z_mm,dx,dy,dz,wavelength_nm\n";

/// One row of the command's answer.
struct TraceRow {
    std::string surface;
    Triple point{};
    Triple direction{};
    double optical_path = 0.0;
    std::string status;
};

using TraceRows = std::map<std::string, std::vector<TraceRow>>;  // by the ray's id

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
    std::istringstream lines(csv);
    std::string line;
    std::getline(lines, line);
    EXPECT_EQ(line, "id,surface,x_mm,y_mm,z_mm,dx,dy,dz,optical_path_mm,transmittance,status");
    while (std::getline(lines, line)) {
        std::vector<std::string> cells;
        std::istringstream stream(line);
        for (std::string cell; std::getline(stream, cell, ',');) {
            cells.push_back(cell);
        }
        if (cells.size() != 11) {
            ADD_FAILURE() << line;
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
