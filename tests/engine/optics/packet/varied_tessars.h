// tests/engine/optics/packet/varied_tessars.h — lenses whose surfaces have more than a sphere and a rim.
#pragma once
#include <array>
#include <string>
#include <vector>

#include "engine/base/file.h"
#include "engine/base/write_file.h"
#include "engine/formats/prescription/load_lens.h"
#include "engine/formats/prescription/prescription_file.h"
#include "tests/test_folder.h"

namespace lensproof::optics {

/// A file with the Tessar and more in it.
inline Lens tessar_with(const std::string& more) {
    const TestFolder folder;
    const std::filesystem::path file = folder.path() / "tessar_with.toml";
    write_file(file, read_file(formats::find_lens_file("tessar")) + more);
    return formats::load_lens(file.string());
}

/// With blades, with turned and displaced groups, with coatings.
inline std::vector<Lens> varied_tessars() {
    return {tessar_with("[stop]\nblades = 6\nrotation_deg = 10\n"),
            tessar_with("[[groups]]\nsurfaces = [3, 6]\ntilt_deg = [1, -2, 0]\ndecentre_mm = [0.3, 0.2]\n"),
            formats::load_lens("tessar", {.coatings = {"broadband,1=v-coat"}})};
}

/// The same bare lens at some wavelengths, its surfaces coated by turns with a stated reflectance, with clear layers
/// and with layers that absorb at all wavelengths but the first.
inline std::vector<TraceLens<double>> coated_by_turns(std::vector<TraceLens<double>> lenses) {
    for (std::size_t wavelength = 0; wavelength < lenses.size(); ++wavelength) {
        const double step = 0.01 * static_cast<double>(wavelength);
        const std::array<TraceCoating<double>, 3> coatings = {
            TraceCoating<double>{.layers = {}, .reflectance = 0.01 + step},
            {.layers = {{1.38, 0.18 + step}, {2.0, 0.1 - step}}},
            {.layers = {{1.38, 0.18}, {1.7, 0.2, step}}}};
        TraceLens<double>& lens = lenses[wavelength];
        for (std::size_t i = 0; i < lens.surfaces.size(); ++i) {
            lens.surfaces[i].special = static_cast<int>(i);
            lens.specials.push_back({.coating = coatings[i % coatings.size()]});
        }
    }
    return lenses;
}

}  // namespace lensproof::optics
