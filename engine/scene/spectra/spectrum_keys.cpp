#include "engine/scene/spectra/spectrum_keys.h"

#include <vector>

#include "engine/base/input_error.h"
#include "engine/base/toml_keys.h"
#include "engine/spectral/illuminant.h"

namespace lensproof::scene {

namespace {

RgbColour read_rgb(TomlTable& table, const std::string& key, const Bounds& bounds) {
    const std::vector<double> rgb = table.numbers(key, 3, bounds);
    return {{rgb[0], rgb[1], rgb[2]}};
}

ImageDescription read_image_texture(TomlTable& table) {
    ImageDescription texture{.file = read_file_name(table, "image")};
    texture.scale = table.number_or("scale", texture.scale, kPositive);
    if (table.has("repeats")) {
        const std::vector<double> repeats = table.numbers("repeats", 2, kPositive);
        texture.repeats = {repeats[0], repeats[1]};
    }
    table.finish();
    return texture;
}

}  // namespace

SpectrumDescription read_spectrum(TomlTable& table, const std::string& key, const Bounds& bounds,
                                  const std::string& column) {
    if (table.is_number(key)) {
        return table.number(key, bounds);
    }
    if (table.is_table(key)) {
        TomlTable inner = table.table(key);
        SpectrumTable spectrum{.file = read_file_name(inner, "file"), .column = inner.text_or("column", column)};
        inner.finish();
        return spectrum;
    }
    if (!table.is_text(key)) {
        return read_rgb(table, key, bounds);
    }
    const std::string name = table.text(key);
    if (name.ends_with(".csv")) {
        return SpectrumTable{.file = file_beside(table, key, name), .column = column};
    }
    if (name.empty()) {
        table.fail(key, "is empty, expected a spectrum's name");
    }
    return SpectrumName{name};
}

TextureDescription read_texture(TomlTable& table, const std::string& key, const Bounds& bounds,
                                const std::string& column) {
    if (table.is_table(key)) {
        TomlTable inner = table.table(key);
        if (inner.has("image")) {
            return read_image_texture(inner);
        }
    }
    return std::visit([](const auto& spectrum) { return TextureDescription(spectrum); },
                      read_spectrum(table, key, bounds, column));
}

std::string read_illuminant(TomlTable& table, const std::string& key) {
    std::string name = table.text_or(key, "D65");
    try {
        spectral::illuminant(name);
    } catch (const InputError& error) {
        table.fail(key, error.what());
    }
    return name;
}

EmissionDescription read_emission(TomlTable& table) {
    if (!table.has("radiance")) {
        return {.illuminant = read_illuminant(table, "illuminant"),
                .luminance_cd_m2 = table.number("luminance_cd_m2", kPower)};
    }
    if (table.has("illuminant")) {
        table.fail("radiance", "stands beside illuminant, expected one or the other");
    }
    const SpectrumDescription spectrum = read_spectrum(table, "radiance", kPower, "radiance");
    const auto* file = std::get_if<SpectrumTable>(&spectrum);
    if (file == nullptr) {
        table.fail("radiance", "expected a CSV table of W·m⁻²·sr⁻¹·nm⁻¹ over wavelength_nm");
    }
    return {.illuminant = "",
            .luminance_cd_m2 = table.has("luminance_cd_m2") ? table.number("luminance_cd_m2", kPower) : 0.0,
            .radiance = *file};
}

}  // namespace lensproof::scene
