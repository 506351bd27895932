#include "experiments/cli/given_rays.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/base/input_error.h"

namespace lensproof::cli {

namespace {

// Far beyond any scene, far below what would overflow when squared, in a float too.
constexpr Bounds kCoordinate{.min = -1e15, .max = 1e15};

}  // namespace

GivenRay read_ray(const CsvRow& row) {
    const auto vector = [&](const char* x, const char* y, const char* z) {
        return Vec3d{row.number(x, kCoordinate), row.number(y, kCoordinate), row.number(z, kCoordinate)};
    };
    const Vec3d stated = vector("dx", "dy", "dz");
    // Scaled first: the square of a tiny number is 0.
    const double largest = std::max({std::abs(stated.x), std::abs(stated.y), std::abs(stated.z)});
    if (!(largest > 0.0)) {
        throw InputError(fmt::format("{} has length 0, expected a direction", row.where("the direction")));
    }
    // By a power of two, which is exact; `ray_in` makes it a unit vector in its own precision.
    const int exponent = std::ilogb(largest);
    const auto scaled = [&](double component) { return std::ldexp(component, -exponent); };
    return {.id = row.text("id"),
            .ray = {vector("x_mm", "y_mm", "z_mm"), {scaled(stated.x), scaled(stated.y), scaled(stated.z)}},
            .wavelength_nm = row.number("wavelength_nm", kPositive)};
}

GivenRays::GivenRays(const std::string& file) : table_(CsvTable::read(file)) {
    table_.expect_columns({"id", "x_mm", "y_mm", "z_mm", "dx", "dy", "dz", "wavelength_nm"});
    if (!CsvTable(table_).next()) {
        throw InputError(fmt::format("{}: holds no ray", file));
    }
}

}  // namespace lensproof::cli
