// engine/spectral/colour_checker.h — the ColorChecker Classic's measured reflectances.
#pragma once
#include <string>
#include <vector>

#include "engine/spectral/spectrum.h"

namespace lensproof::spectral {

struct ColourPatch {
    std::string name;  // "dark_skin"
    Spectrum reflectance;
};

/// Its 24 patches, row by row from the top left (dark skin) to the bottom right (black), 380 to 780 nm, as Ohta
/// measured them (1997; ISO 17321-1:2012). Throws InputError where the project's own data is damaged.
std::vector<ColourPatch> colour_checker();

}  // namespace lensproof::spectral
