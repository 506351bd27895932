#include "engine/formats/prescription/coating_toml.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace lensproof::formats {

std::vector<optics::WavelengthValue> read_wavelength_values(TomlTable& table, const std::string& key,
                                                            const Bounds& values) {
    std::vector<optics::WavelengthValue> read;
    for (const std::vector<double>& pair : table.number_lists(key)) {
        const bool good = pair.size() == 2 && pair[0] > 0.0 && pair[1] >= values.min && pair[1] <= values.max &&
                          (read.empty() || pair[0] > read.back().wavelength_nm);
        if (!good) {
            table.fail(key, fmt::format("holds [{}], expected pairs [wavelength in nm, value from {} to {}] by rising "
                                        "wavelength",
                                        fmt::join(pair, ", "), values.min, values.max));
        }
        read.push_back({pair[0], pair[1]});
    }
    if (read.empty()) {
        table.fail(key, "is empty, expected pairs [wavelength in nm, value]");
    }
    return read;
}

namespace {

constexpr Bounds kFilmThickness{.min = 0.0, .max = 1e9, .min_excluded = true};  // nm: a metre is no film
constexpr std::size_t kMostLayers = 1000;

/// A number, which holds at every wavelength, or pairs as above.
std::vector<optics::WavelengthValue> read_dispersion(TomlTable& table, const std::string& key, const Bounds& values) {
    if (table.is_number(key)) {
        return {{550.0, table.number(key, values)}};
    }
    return read_wavelength_values(table, key, values);
}

optics::CoatingLayer read_layer(TomlTable& table) {
    optics::CoatingLayer layer;
    if (table.has("material") && !table.has("n")) {
        layer.material = table.text("material");
    } else if (table.has("material")) {
        table.fail("n", "stands beside a material, expected one of the two");
    } else {
        layer.index = read_dispersion(table, "n", {.min = 0.01, .max = 10.0});
    }
    if (table.has("k")) {
        layer.extinction = read_dispersion(table, "k", {.min = 0.0, .max = 20.0});
    }
    if (table.has("quarter_wave_nm")) {
        layer.quarter_wave_nm = table.number("quarter_wave_nm", kFilmThickness);
        if (layer.index.size() == 1) {
            layer.thickness_nm = layer.quarter_wave_nm / (4.0 * layer.index.front().value);
            layer.quarter_wave_nm = 0.0;
        }
    } else {
        layer.thickness_nm = table.number("thickness_nm", kFilmThickness);
    }
    table.finish();
    return layer;
}

}  // namespace

optics::Coating read_coating(TomlTable& table) {
    optics::Coating coating;
    if (table.has("reflectance")) {
        coating =
            table.is_number("reflectance")
                ? std::vector<optics::WavelengthValue>{{550.0, table.number("reflectance", {.min = 0.0, .max = 1.0})}}
                : read_wavelength_values(table, "reflectance", {.min = 0.0, .max = 1.0});
    } else {
        optics::LayerStack stack;
        for (TomlTable& layer : table.tables("layers")) {
            stack.layers.push_back(read_layer(layer));
        }
        if (stack.layers.empty()) {
            table.fail("", "expected layers = [{ n = …, thickness_nm = … or quarter_wave_nm = … }], or reflectance");
        }
        if (stack.layers.size() > kMostLayers) {
            table.fail("layers", fmt::format("holds {} layers, expected up to {}", stack.layers.size(), kMostLayers));
        }
        stack.from_air = table.boolean_or("from_air", false);
        coating = std::move(stack);
    }
    table.finish();
    return coating;
}

}  // namespace lensproof::formats
