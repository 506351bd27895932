// engine/analysis/ghost_pictures.h — the pictures that a lens's ghosts of a distant light make on a sensor.
#pragma once
#include <vector>

#include "engine/analysis/ghost_mesh.h"
#include "engine/analysis/ghosts.h"

namespace lensproof::analysis {

struct PictureSettings {
    int width = 0;  // pixels
    int height = 0;
    double pitch_mm = 0.0;
    std::vector<double> wavelengths_nm;
    double energy_error = MeshSettings{}.energy_error;
    double place_error_px = 0.5;
};

/// Energy a pixel over the light that enters the entrance pupil, as LightRaster has it; one a wavelength.
using SpectralPixels = std::vector<std::vector<double>>;

struct GhostPicture {
    std::vector<MeshedGhost> at;  // each wavelength; energies are those on the sensor's circle, through its corners
    SpectralPixels pixels;        // of those ghosts alone that were to have a picture of their own
};

struct GhostPictures {
    SpectralPixels sum;
    std::vector<GhostPicture> ghosts;
};

/// Draws the ghosts along `paths`; the first `separate` of them by themselves, too. Of `settings` the source, the
/// mirrors and the reference wavelength count, in which regions are searched; light counts on the whole sensor, and
/// nowhere else. The same for any number of threads. Throws as survey_ghosts does.
GhostPictures draw_ghosts(const optics::Lens& lens, const GhostSettings& settings, const PictureSettings& picture,
                          const std::vector<optics::GhostPath>& paths, std::size_t separate);

}  // namespace lensproof::analysis
