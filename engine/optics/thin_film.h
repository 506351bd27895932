// engine/optics/thin_film.h — a coating from its statement to what is traced at a wavelength.
#pragma once
#include <string>
#include <variant>
#include <vector>

#include "engine/optics/coating.h"
#include "engine/optics/glass_catalogue.h"
#include "engine/optics/prescription.h"

namespace lensproof::optics {

/// A layer with its material looked up.
struct ThinFilm {
    Glass medium;                             // its n, and where all of its data hold
    std::vector<WavelengthValue> extinction;  // its κ; empty: 0
    double thickness_nm = 0.0;
};

/// Layers from the scene's side to the sensor's, or a stated reflectance; neither: bare.
using LensCoating = std::variant<std::vector<ThinFilm>, std::vector<WavelengthValue>>;

/// A glass of the same index at every wavelength.
Glass constant_glass(std::string name, double index);

/// A glass of measured indices, by rising wavelength; a single one holds at every wavelength.
Glass tabulated_glass(const std::string& name, const std::vector<WavelengthValue>& indices);

/// The layers in their order on a surface between `before` and `behind`. Throws InputError, led by `where`, for a
/// material that no catalogue has, and for a layer without data at the wavelength of its quarter.
LensCoating resolved_coating(const Coating& coating, const GlassCatalogue& glasses, const Glass& before,
                             const Glass& behind, const std::string& where);

/// The coating at one wavelength. Throws InputError, led by `where`, where a layer has no data there.
TraceCoating<double> coating_at(const LensCoating& coating, double wavelength_nm, const std::string& where);

}  // namespace lensproof::optics
