#include "engine/spectral/colour_checker.h"

#include <utility>

namespace lensproof::spectral {

std::vector<ColourPatch> colour_checker() {
    const std::vector<std::string> names = {
        "dark_skin", "light_skin",    "blue_sky",     "foliage",   "blue_flower",  "bluish_green",
        "orange",    "purplish_blue", "moderate_red", "purple",    "yellow_green", "orange_yellow",
        "blue",      "green",         "red",          "yellow",    "magenta",      "cyan",
        "white_9_5", "neutral_8",     "neutral_6_5",  "neutral_5", "neutral_3_5",  "black_2"};
    std::vector<Spectrum> reflectances = read_spectra(spectral_data("colour-checker.csv"), names);
    std::vector<ColourPatch> patches;
    for (std::size_t i = 0; i < names.size(); ++i) {
        patches.push_back({.name = names[i], .reflectance = std::move(reflectances[i])});
    }
    return patches;
}

}  // namespace lensproof::spectral
