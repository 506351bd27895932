// experiments/cli/ghost_image.h — `lensproof ghosts --image`: what ghosts make of a sensor, as an EXR file.
#pragma once
#include <string>
#include <vector>

#include "engine/analysis/ghost_pictures.h"
#include "experiments/cli/command_line.h"

namespace lensproof::cli {

struct GhostImageOptions {
    std::string file;
    std::vector<double> pixels{1000.0, 1000.0};
    std::vector<double> sensor_mm;
};

/// Adds --image, --pixels and --sensor-mm.
void add_ghost_image_options(Command& command, GhostImageOptions& options);

/// The sensor's pixels. Throws InputError for sizes that cannot be, and for pixels that are not square. What
/// --sensor-mm does not say, the image circle's diameter does.
analysis::PictureSettings picture_settings(const GhostImageOptions& options, double image_circle_mm,
                                           std::vector<double> wavelengths_nm, std::size_t layers);

/// A ghost with a part of its own.
struct GhostLayer {
    std::string name;  // "4,2"
    std::string row;   // of the table, as JSON
};

/// Writes the sum of all ghosts as the part "ghosts", with `about` as its attribute "lensproof:ghosts", and one for
/// each layer, "ghost 4,2", with its row as "lensproof:ghost": irradiance in W·m⁻²·nm⁻¹ for a light that has 1
/// W·m⁻²·nm⁻¹ across its way at every wavelength, in spectral channels; R, G, B (Rec. 709) are what the CIE's observer
/// sees of that, 1 for an irradiance of 1.
void write_ghost_image(const std::string& file, const analysis::PictureSettings& picture, double pupil_area_mm2,
                       const analysis::GhostPictures& pictures, const std::string& about,
                       const std::vector<GhostLayer>& layers);

}  // namespace lensproof::cli
