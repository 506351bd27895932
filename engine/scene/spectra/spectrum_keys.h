// engine/scene/spectra/spectrum_keys.h — spectra as files state them: values that name what is meant, nothing looked up
// or loaded but names checked.
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <variant>

#include "engine/base/toml.h"
#include "engine/base/vec.h"

namespace lensproof::scene {

/// Linear sRGB, to be uplifted to a spectrum.
struct RgbColour {
    Vec3d rgb;
};

/// A spectrum by its name among the project's data, say "metal:Ag".
struct SpectrumName {
    std::string name;
};

/// A column of a CSV table over `wavelength_nm`.
struct SpectrumTable {
    std::filesystem::path file;
    std::string column;
};

/// A number is the same at every wavelength.
using SpectrumDescription = std::variant<double, RgbColour, SpectrumName, SpectrumTable>;

/// A picture on the surface, uplifted texel by texel. uv (0, 0) is its lower left corner.
struct ImageDescription {
    std::filesystem::path file;
    double scale = 1.0;       // of its linear values
    Vec2d repeats{1.0, 1.0};  // how often it stands side by side along u and v
};

using TextureDescription = std::variant<double, RgbColour, SpectrumName, SpectrumTable, ImageDescription>;

/// The optical constants of a metal by the name of the data for both, or each as a spectrum.
struct ConductorIndex {
    std::string name;  // "metal:Ag"; empty: n and k say it
    SpectrumDescription n = 1.0;
    SpectrumDescription k = 0.0;
};

/// A dielectric's index: the same at every wavelength, or a glass of the catalogues.
using DielectricIndex = std::variant<double, SpectrumName>;

/// A surface's or the sky's light: an illuminant's spectrum, or a table of radiance; at a luminance, or as the table
/// says.
struct EmissionDescription {
    std::string illuminant = "D65";         // unused with a table
    double luminance_cd_m2 = 0.0;           // 0: the table is absolute
    std::optional<SpectrumTable> radiance;  // W·m⁻²·sr⁻¹·nm⁻¹, or relative
};

/// Of lights. One without power is an error: whoever wants none leaves it out.
inline constexpr Bounds kPower{.min = 0.0, .max = 1e15, .min_excluded = true};

// All throw InputError naming file, line and key.

/// A number within `bounds`, [r, g, b] within them, a name, a name of a CSV file, or { file = "…", column = "…" }.
/// `column` is that of a CSV file which is named alone.
SpectrumDescription read_spectrum(TomlTable& table, const std::string& key, const Bounds& bounds,
                                  const std::string& column);
/// The same, or { image = "…", scale = 1, repeats = [1, 1] }.
TextureDescription read_texture(TomlTable& table, const std::string& key, const Bounds& bounds,
                                const std::string& column);

/// The name of an illuminant that is known; D65 where the key is absent.
std::string read_illuminant(TomlTable& table, const std::string& key);

/// luminance_cd_m2 with an illuminant, or a table of radiance, with luminance_cd_m2 if need be.
EmissionDescription read_emission(TomlTable& table);

}  // namespace lensproof::scene
