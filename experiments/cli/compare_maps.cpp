#include "experiments/cli/compare_maps.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>

#include "engine/base/order_statistics.h"
#include "engine/base/write_file.h"
#include "engine/formats/image/image.h"
#include "experiments/draw/analysis_plots.h"
#include "experiments/draw/coloured_image.h"

namespace lensproof::cli {

namespace {

constexpr double kLeastRange = 1e-4;

/// What 999 of 1000 values do not exceed.
double nearly_largest(const formats::Image& values) {
    std::vector<float> magnitudes;
    magnitudes.reserve(values.pixels.size());
    for (const float value : values.pixels) {
        magnitudes.push_back(std::abs(value));
    }
    return static_cast<double>(quantile(magnitudes, 0.999));
}

}  // namespace

void check_maps_folder(const std::string& folder) {
    check_output_name(std::filesystem::path(folder) / "difference.png");
}

std::vector<DrawnMap> drawn_maps(const calibration::PictureComparison& found) {
    std::vector<DrawnMap> maps;
    const auto add = [&](const std::string& quantity, const formats::Image& values, draw::ColourMap colours,
                         double lowest, double highest) {
        maps.push_back({quantity, lowest, highest, draw::coloured_image(values, colours, lowest, highest)});
    };
    if (found.difference) {
        const double range = std::max(kLeastRange, nearly_largest(found.difference->map));
        add("difference", found.difference->map, draw::ColourMap::diverging, -range, range);
    }
    if (found.flip_map) {
        add("flip", *found.flip_map, draw::ColourMap::sequential, 0.0, 1.0);
    }
    if (found.ciede2000_map) {
        add("ciede2000", *found.ciede2000_map, draw::ColourMap::sequential, 0.0,
            std::max(1.0, nearly_largest(*found.ciede2000_map)));
    }
    return maps;
}

Json write_maps(const std::vector<DrawnMap>& maps, const std::string& folder) {
    std::map<std::string, std::string> files;
    Json told = Json::list();
    for (const DrawnMap& map : maps) {
        files[map.quantity + ".png"] = formats::encode_png(map.picture);
        told.push_back(Json{{"file", (std::filesystem::path(folder) / (map.quantity + ".png")).string()},
                            {"quantity", map.quantity},
                            {"lowest", map.lowest},
                            {"highest", map.highest}});
    }
    draw::write_plots(folder, files);
    return told;
}

}  // namespace lensproof::cli
