#include "engine/scene/chart/chart_file.h"

#include <fmt/format.h>

#include "engine/scene/chart/chart_keys.h"

namespace lensproof::scene {

namespace {

constexpr Bounds kReflectance{.min = 0.0, .max = 1.0};
constexpr Bounds kLength{.min = 0.0, .max = 1e9, .min_excluded = true};

/// Reads what a kind says of its keys.
class ReadKeys {
  public:
    explicit ReadKeys(TomlTable& table) : table_(table) {}

    void grid(const std::string& key, int& columns, int& rows, const GridKey& says) {
        const std::vector<double> counts =
            table_.numbers(key, 2, {.min = static_cast<double>(says.least), .max = 1000.0});
        columns = static_cast<int>(counts[0]);
        rows = static_cast<int>(counts[1]);
        if (columns != counts[0] || rows != counts[1]) {
            refuse(key, "expected whole numbers of columns and rows");
        }
    }
    void pitch(const std::string& key, double& mm, GridSize /*cells*/) { mm = table_.number(key, kLength); }
    void length(const std::string& key, double& mm, GridSize /*cells*/) { mm = table_.number(key, kLength); }
    void part(const std::string& key, double& mm, const PartKey& says) {
        mm = table_.number(key, kLength);
        if (!(mm < says.most_mm)) {
            refuse(key, fmt::format("is {}, expected less than {}, which is {}", mm, says.of, says.most_mm));
        }
    }
    void whole(const std::string& key, int& number, const WholeKey& says) {
        number = table_.integer(key, says.least, says.most);
    }
    void angle(const std::string& key, double& deg, double most_deg) {
        deg = table_.number_or(key, deg, {.min = -most_deg, .max = most_deg});
    }
    std::string choice(const std::string& key, const std::vector<std::string>& names, const char* /*printed*/) {
        return table_.choice(key, names);
    }
    [[noreturn]] void refuse(const std::string& key, const std::string& why) const { table_.fail(key, why); }

  private:
    TomlTable& table_;
};

}  // namespace

Chart read_chart(TomlTable& table) {
    ReadKeys keys(table);
    const std::string kind = table.choice("kind", kind_names<ChartPattern>());
    Chart chart{.pattern = of_kind<ChartPattern>(kind, [&](auto& pattern) { visit_keys(pattern, keys); })};
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
