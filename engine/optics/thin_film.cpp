#include "engine/optics/thin_film.h"

#include <fmt/format.h>

#include <algorithm>

#include "engine/base/infinity.h"
#include "engine/base/input_error.h"
#include "engine/base/text.h"
#include "engine/spectral/wavelengths.h"

namespace lensproof::optics {

namespace {

void require_covers(const ThinFilm& film, double wavelength_nm, const std::string& where) {
    if (!covers(film.medium, wavelength_nm)) {
        throw InputError(fmt::format("{}: {} nm is outside the range of a coating's layer of {}, {} to {} nm", where,
                                     wavelength_nm, film.medium.name, film.medium.min_wavelength_nm,
                                     film.medium.max_wavelength_nm));
    }
}

ThinFilm resolved_film(const CoatingLayer& layer, const GlassCatalogue& glasses, const std::string& where) {
    ThinFilm film{.medium = {}, .extinction = layer.extinction, .thickness_nm = layer.thickness_nm};
    if (layer.material.empty()) {
        const bool is_constant = layer.index.size() == 1;
        film.medium = tabulated_glass(is_constant ? fmt::format("n = {}", layer.index.front().value)
                                                  : fmt::format("{} indices", layer.index.size()),
                                      layer.index);
    } else {
        GlassMatch match = glasses.resolve(layer.material);
        if (!match.glass) {
            throw InputError(fmt::format("{}: a layer's material is \"{}\", which no catalogue has; {}. Or state n.",
                                         where, printable(layer.material), suggestion_text(match.suggestions)));
        }
        film.medium = std::move(*match.glass);
    }
    if (layer.extinction.size() > 1) {
        film.medium.min_wavelength_nm = std::max(film.medium.min_wavelength_nm, layer.extinction.front().wavelength_nm);
        film.medium.max_wavelength_nm = std::min(film.medium.max_wavelength_nm, layer.extinction.back().wavelength_nm);
    }
    if (layer.quarter_wave_nm > 0.0) {
        require_covers(film, layer.quarter_wave_nm, where);
        film.thickness_nm =
            layer.quarter_wave_nm / (4.0 * refractive_index(film.medium.formula, layer.quarter_wave_nm));
    }
    return film;
}

}  // namespace

Glass constant_glass(std::string name, double index) {
    Glass glass;
    glass.name = std::move(name);
    glass.formula = ConstantIndex{index};
    glass.max_wavelength_nm = kInfinity;
    return glass;
}

Glass tabulated_glass(const std::string& name, const std::vector<WavelengthValue>& indices) {
    if (indices.size() == 1) {
        return constant_glass(name, indices.front().value);
    }
    Glass glass;
    glass.name = name;
    IndexTable table;
    for (const WavelengthValue& entry : indices) {
        table.wavelength_um.push_back(1e-3 * entry.wavelength_nm);
        table.index.push_back(entry.value);
    }
    glass.formula = std::move(table);
    glass.min_wavelength_nm = indices.front().wavelength_nm;
    glass.max_wavelength_nm = indices.back().wavelength_nm;
    return glass;
}

LensCoating resolved_coating(const Coating& coating, const GlassCatalogue& glasses, const Glass& before,
                             const Glass& behind, const std::string& where) {
    const auto* stack = std::get_if<LayerStack>(&coating);
    if (stack == nullptr) {
        return std::get<std::vector<WavelengthValue>>(coating);
    }
    std::vector<ThinFilm> films;
    for (const CoatingLayer& layer : stack->layers) {
        films.push_back(resolved_film(layer, glasses, where));
    }
    const auto index_d = [](const Glass& glass) { return refractive_index(glass.formula, spectral::kLineD); };
    if (stack->from_air && index_d(before) > index_d(behind)) {
        std::ranges::reverse(films);
    }
    return films;
}

TraceCoating<double> coating_at(const LensCoating& coating, double wavelength_nm, const std::string& where) {
    TraceCoating<double> traced;
    if (const auto* films = std::get_if<std::vector<ThinFilm>>(&coating)) {
        for (const ThinFilm& film : *films) {
            require_covers(film, wavelength_nm, where);
            traced.layers.push_back(
                {.index = refractive_index(film.medium.formula, wavelength_nm),
                 .thickness = film.thickness_nm / wavelength_nm,
                 .extinction = film.extinction.empty() ? 0.0 : interpolated(film.extinction, wavelength_nm)});
        }
    } else {
        traced.reflectance = interpolated(std::get<std::vector<WavelengthValue>>(coating), wavelength_nm);
    }
    return traced;
}

}  // namespace lensproof::optics
