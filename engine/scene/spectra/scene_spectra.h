// engine/scene/spectra/scene_spectra.h — the spectra that a scene names, tabulated on a render's grid.
#pragma once
#include <optional>
#include <string>

#include "engine/base/cache.h"
#include "engine/scene/spectra/spectrum_keys.h"
#include "engine/scene/spectra/texture.h"
#include "engine/spectral/metal.h"
#include "engine/spectral/rgb_uplift.h"

namespace lensproof::scene {

/// Looks up what descriptions of spectra mean. All throw InputError for an unknown name, listing the names that are
/// known, and for a file that cannot be used.
///
/// Names: of reflectances the patches of the colour checker, "patch:dark_skin" and so on; of metals "metal:Ag" or
/// "metal:silver"; of glasses their names in the catalogues.
class SceneSpectra {
  public:
    SceneSpectra(const spectral::SpectralGrid& grid, const Cache& cache) : grid_(grid), cache_(cache) {}

    [[nodiscard]] const spectral::SpectralGrid& grid() const { return grid_; }

    /// Values at the midpoints of strata; beyond a table's ends its last values.
    spectral::GridSpectrum at_midpoints(const SpectrumDescription& spectrum);
    Texture texture(const TextureDescription& texture);

    /// n and k.
    struct Metal {
        spectral::GridSpectrum n;
        spectral::GridSpectrum k;
    };
    Metal metal(const ConductorIndex& index);

    /// An index relative to air. One that is asked for at a single wavelength is that of the d line.
    spectral::GridSpectrum index(const DielectricIndex& index);
    static double index_at_d(const DielectricIndex& index);

    /// Radiance, the mean over each stratum.
    spectral::GridSpectrum radiance(const EmissionDescription& emission);
    /// The same before it is tabulated.
    static spectral::Spectrum radiance_spectrum(const EmissionDescription& emission);

    /// The table of the uplift, made or fetched when it is first asked for.
    const spectral::RgbUplift& uplift();

  private:
    spectral::SpectralGrid grid_;
    const Cache& cache_;
    std::optional<spectral::RgbUplift> uplift_;
};

}  // namespace lensproof::scene
