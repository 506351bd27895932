#include "engine/scene/spectra/scene_spectra.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <utility>

#include "engine/base/input_error.h"
#include "engine/base/overloaded.h"
#include "engine/formats/glass/shipped_glasses.h"
#include "engine/optics/dispersion.h"
#include "engine/optics/glass_catalogue.h"
#include "engine/spectral/colour_checker.h"
#include "engine/spectral/colour_matching.h"
#include "engine/spectral/illuminant.h"

namespace lensproof::scene {

namespace {

constexpr std::string_view kPatchPrefix = "patch:";
constexpr std::string_view kMetalPrefix = "metal:";

spectral::Spectrum read_column(const SpectrumTable& table) {
    return spectral::read_spectra(table.file, {table.column}).front();
}

/// A reflectance by name.
spectral::Spectrum named_reflectance(const std::string& name) {
    const std::vector<spectral::ColourPatch> patches = spectral::colour_checker();
    std::vector<std::string> known;
    for (const spectral::ColourPatch& patch : patches) {
        known.push_back(std::string(kPatchPrefix) + patch.name);
        if (known.back() == name) {
            return patch.reflectance;
        }
    }
    throw InputError(fmt::format("\"{}\" is no spectrum that is known; there are {}", name, fmt::join(known, ", ")));
}

/// "metal:Ag" or "metal:silver", with or without the prefix.
spectral::ComplexIndex named_metal(std::string name) {
    static const std::map<std::string, std::string> kBySymbol = {
        {"Ag", "silver"}, {"Al", "aluminium"}, {"Au", "gold"}, {"Cr", "chromium"}, {"Cu", "copper"}, {"Fe", "iron"}};
    if (name.starts_with(kMetalPrefix)) {
        name.erase(0, kMetalPrefix.size());
    }
    const auto symbol = kBySymbol.find(name);
    return spectral::metal(symbol != kBySymbol.end() ? symbol->second : name);
}

/// What a glass's formula gives, where it holds.
double index_of(const optics::Glass& glass, double nm) {
    if (!optics::covers(glass, nm)) {
        throw InputError(fmt::format("the glass {} is known from {:.1f} to {:.1f} nm only, not at {:.1f} nm",
                                     glass.name, glass.min_wavelength_nm, glass.max_wavelength_nm, nm));
    }
    return optics::refractive_index(glass.formula, nm);
}

optics::Glass named_glass(const std::string& name) {
    const optics::GlassMatch match = formats::shipped_glasses().resolve(name);
    if (match.glass) {
        return *match.glass;
    }
    std::vector<std::string> near;
    std::ranges::transform(match.suggestions, std::back_inserter(near), &optics::GlassSuggestion::name);
    throw InputError(fmt::format("\"{}\" is no glass of the catalogues{}", name,
                                 near.empty() ? std::string() : fmt::format("; near it: {}", fmt::join(near, ", "))));
}

}  // namespace

const spectral::RgbUplift& SceneSpectra::uplift() {
    if (!uplift_) {
        uplift_ = spectral::kept_rgb_uplift(cache_);
    }
    return *uplift_;
}

spectral::GridSpectrum SceneSpectra::at_midpoints(const SpectrumDescription& spectrum) {
    return std::visit(Overloaded{[&](double number) { return spectral::constant_spectrum(number, grid_); },
                                 [&](const RgbColour& colour) { return rgb_reflectance(colour.rgb, grid_, uplift()); },
                                 [&](const SpectrumName& name) {
                                     return lensproof::spectral::at_midpoints(named_reflectance(name.name), grid_);
                                 },
                                 [&](const SpectrumTable& table) {
                                     return lensproof::spectral::at_midpoints(read_column(table), grid_);
                                 }},
                      spectrum);
}

Texture SceneSpectra::texture(const TextureDescription& texture) {
    return std::visit(Overloaded{[&](const ImageDescription& image) -> Texture {
                                     ImageTexture made = reflectance_texture(image.file, Wrap::repeat, grid_, uplift());
                                     made.repeats = image.repeats;
                                     for (ImageTexture::Texel& texel : made.texel) {
                                         texel.scale *= static_cast<float>(image.scale);
                                     }
                                     return made;
                                 },
                                 [&](const auto& even) -> Texture { return at_midpoints(SpectrumDescription(even)); }},
                      texture);
}

SceneSpectra::Metal SceneSpectra::metal(const ConductorIndex& index) {
    if (!index.name.empty()) {
        const bool is_file = index.name.ends_with(".csv");
        const spectral::ComplexIndex found =
            is_file ? spectral::read_complex_index(index.name) : named_metal(index.name);
        return {lensproof::spectral::at_midpoints(found.n, grid_), lensproof::spectral::at_midpoints(found.k, grid_)};
    }
    return {at_midpoints(index.n), at_midpoints(index.k)};
}

spectral::GridSpectrum SceneSpectra::index(const DielectricIndex& index) {
    if (const auto* number = std::get_if<double>(&index)) {
        return spectral::constant_spectrum(*number, grid_);
    }
    const optics::Glass glass = named_glass(std::get<SpectrumName>(index).name);
    return spectral::tabulated(grid_, [&](double nm) { return index_of(glass, nm); });
}

double SceneSpectra::index_at_d(const DielectricIndex& index) {
    const auto* number = std::get_if<double>(&index);
    return number != nullptr ? *number : index_of(named_glass(std::get<SpectrumName>(index).name), spectral::kLineD);
}

spectral::Spectrum SceneSpectra::radiance_spectrum(const EmissionDescription& emission) {
    if (!emission.radiance) {
        return spectral::radiance_of(spectral::illuminant(emission.illuminant), emission.luminance_cd_m2);
    }
    spectral::Spectrum table = read_column(*emission.radiance);
    if (!(emission.luminance_cd_m2 > 0.0)) {
        return table;
    }
    const double luminance = spectral::tristimulus(table, spectral::cie_1931()).y;
    if (!(luminance > 0.0)) {
        throw InputError(fmt::format("{}: column {} has no luminance that could be scaled to {} cd/m²",
                                     emission.radiance->file.string(), emission.radiance->column,
                                     emission.luminance_cd_m2));
    }
    return emission.luminance_cd_m2 / luminance * std::move(table);
}

spectral::GridSpectrum SceneSpectra::radiance(const EmissionDescription& emission) {
    return spectral::stratum_means(radiance_spectrum(emission), grid_);
}

}  // namespace lensproof::scene
