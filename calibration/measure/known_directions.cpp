#include "calibration/measure/known_directions.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/base/angle.h"
#include "engine/base/csv.h"
#include "engine/base/input_error.h"

namespace lensproof::calibration {
namespace {

Vec3d on_sphere(double longitude_deg, double latitude_deg) {
    const double longitude = radians(longitude_deg);
    const double latitude = radians(latitude_deg);
    return {std::cos(latitude) * std::cos(longitude), std::cos(latitude) * std::sin(longitude), std::sin(latitude)};
}

/// One way to state a direction.
struct Notation {
    std::vector<std::string> columns;
    Vec3d (*direction_in)(const CsvRow& row);
};

constexpr Bounds kTurn{.min = -360.0, .max = 360.0};
constexpr Bounds kLatitude{.min = -90.0, .max = 90.0};

const std::vector<Notation>& notations() {
    static const std::vector<Notation> all = {
        {{"right_ascension_deg", "declination_deg"},
         [](const CsvRow& row) {
             return on_sphere(row.number("right_ascension_deg", kTurn), row.number("declination_deg", kLatitude));
         }},
        {{"azimuth_deg", "altitude_deg"},
         [](const CsvRow& row) {
             return on_sphere(-row.number("azimuth_deg", kTurn), row.number("altitude_deg", kLatitude));
         }},
        {{"dx", "dy", "dz"}, [](const CsvRow& row) {
             const Vec3d direction{row.number("dx"), row.number("dy"), row.number("dz")};
             const double size = length(direction);
             if (!(size > 0.0) || !std::isfinite(size)) {
                 row.fail("dx", "a direction, of a length that is not 0");
             }
             return (1.0 / size) * direction;
         }}};
    return all;
}

const Notation& notation_of(const CsvTable& table) {
    const auto found = std::ranges::find_if(
        notations(), [&](const Notation& notation) { return table.has(notation.columns.front()); });
    if (found == notations().end()) {
        throw InputError(
            fmt::format("{}: the header is \"{}\", expected x_px, y_px and directions: right_ascension_deg and "
                        "declination_deg, azimuth_deg and altitude_deg, or dx, dy and dz",
                        table.where_header(), table.shown_header()));
    }
    std::vector<std::string> required = {"x_px", "y_px"};
    required.insert(required.end(), found->columns.begin(), found->columns.end());
    table.expect_columns(required, {"picture", "name"});
    return *found;
}

}  // namespace

KnownDirections read_known_directions(const std::filesystem::path& file, const std::vector<std::string>& pictures) {
    CsvTable table = CsvTable::read(file);
    const Notation& notation = notation_of(table);
    const bool names_pictures = table.has("picture");
    if (!names_pictures && pictures.size() != 1) {
        throw InputError(fmt::format("{}: there is no column picture, expected one for {} pictures",
                                     table.where_header(), pictures.size()));
    }
    KnownDirections directions;
    std::size_t count = 0;
    while (const std::optional<CsvRow> row = table.next()) {
        const std::optional<double> x = row->optional_number("x_px");
        const std::optional<double> y = row->optional_number("y_px");
        if (x.has_value() != y.has_value()) {
            row->fail(x ? "y_px" : "x_px", "a number beside the other, or both empty");
        }
        KnownDirection known{.near_px = {}, .direction = notation.direction_in(*row)};
        if (x) {
            known.near_px = Vec2d{*x, *y};
        }
        const std::string picture = names_pictures ? row->text("picture") : pictures.front();
        const bool is_in_all = picture.empty() && !x;
        count += is_in_all ? pictures.size() : 1;
        if (count > kMostDirections) {
            row->fail("x_px", fmt::format("no more than {} directions in all pictures", kMostDirections));
        }
        if (is_in_all) {
            for (const std::string& every : pictures) {
                directions[every].push_back(known);
            }
            continue;
        }
        if (std::ranges::find(pictures, picture) == pictures.end()) {
            row->fail("picture",
                      "the name of a picture that is given: " + fmt::format("{}", fmt::join(pictures, ", ")));
        }
        directions[picture].push_back(known);
    }
    return directions;
}

}  // namespace lensproof::calibration
