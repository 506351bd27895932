#include "engine/analysis/ghost_pictures.h"

#include <cmath>

#include "engine/base/parallel.h"

namespace lensproof::analysis {

GhostPictures draw_ghosts(const optics::Lens& lens, const GhostSettings& settings, const PictureSettings& picture,
                          const std::vector<optics::GhostPath>& paths, std::size_t separate) {
    GhostSettings on_sensor = settings;
    on_sensor.image_radius = 0.5 * picture.pitch_mm * std::hypot(picture.width, picture.height);
    const GhostScene reference = ghost_scene(lens, on_sensor, settings.reference_wavelength_nm);
    std::vector<GhostRegion> regions(paths.size());
    parallel_for(static_cast<int>(paths.size()), settings.threads, [&](int i) {
        const auto at = static_cast<std::size_t>(i);
        constexpr double kRoughly = 0.5;  // a mesh finds the rims by itself
        regions[at] = ghost_region(reference, paths[at], kRoughly);
    });

    const std::size_t wavelengths = picture.wavelengths_nm.size();
    const MeshSettings mesh{.energy_error = picture.energy_error,
                            .place_error = picture.place_error_px * picture.pitch_mm};
    GhostPictures pictures;
    pictures.sum.resize(wavelengths);
    pictures.ghosts.resize(paths.size());
    for (std::size_t i = 0; i < paths.size(); ++i) {
        pictures.ghosts[i].at.resize(wavelengths);
        pictures.ghosts[i].pixels.resize(i < separate ? wavelengths : 0);
    }
    // One thread a wavelength, so that light adds up in the same order for any number of them.
    parallel_for(static_cast<int>(wavelengths), settings.threads, [&](int k) {
        const auto at = static_cast<std::size_t>(k);
        const GhostScene scene = ghost_scene(lens, on_sensor, picture.wavelengths_nm[at]);
        LightRaster sum(picture.width, picture.height, picture.pitch_mm);
        const auto draw = [&](std::size_t i, LightRaster& raster) {
            pictures.ghosts[i].at[at] =
                mesh_ghost(scene, paths[i], regions[i], mesh,
                           [&](const std::array<Vec2d, 3>& corners, double energy) { raster.add(corners, energy); });
        };
        for (std::size_t i = 0; i < paths.size(); ++i) {
            if (i < separate) {
                LightRaster alone(picture.width, picture.height, picture.pitch_mm);
                draw(i, alone);
                sum.add(alone);
                pictures.ghosts[i].pixels[at] = alone.pixels();
            } else {
                draw(i, sum);
            }
        }
        pictures.sum[at] = sum.pixels();
    });
    return pictures;
}

}  // namespace lensproof::analysis
