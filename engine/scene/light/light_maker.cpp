#include "engine/scene/light/light_maker.h"

#include <algorithm>

#include "engine/base/input_error.h"
#include "engine/spectral/illuminant.h"

namespace lensproof::scene {

spectral::GridSpectrum LightMaker::radiance(const EmissionDescription& emission) const {
    return shining(SceneSpectra::radiance_spectrum(emission));
}

/// As radiance follows from cd/m².
spectral::GridSpectrum LightMaker::intensity(const std::string& illuminant, double intensity_cd) const {
    return shining(spectral::radiance_of(spectral::illuminant(illuminant), intensity_cd));
}

spectral::GridSpectrum LightMaker::shining(const spectral::Spectrum& spectrum) const {
    spectral::GridSpectrum means = spectral::stratum_means(spectrum, spectra.grid());
    if (std::ranges::none_of(means.value, [](float value) { return value > 0.0F; })) {
        throw InputError("the light has no power between the render's wavelengths");
    }
    return means;
}

}  // namespace lensproof::scene
