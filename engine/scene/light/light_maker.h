// engine/scene/light/light_maker.h — what lights are made with, from what a file says of them.
#pragma once
#include <functional>
#include <string>

#include "engine/base/vec.h"
#include "engine/scene/spectra/scene_spectra.h"
#include "engine/spectral/spectral_sample.h"

namespace lensproof::scene {

/// A scene that is being built. All throw InputError for a spectrum that sends nothing within the grid.
struct LightMaker {
    SceneSpectra& spectra;
    /// Puts a black ball into the scene; returns its object.
    std::function<std::uint32_t(const Vec3d& centre_mm, double radius_mm)> add_black_ball;

    /// Of a surface or the sky.
    [[nodiscard]] spectral::GridSpectrum radiance(const EmissionDescription& emission) const;
    /// W·sr⁻¹·nm⁻¹ of so many candela.
    [[nodiscard]] spectral::GridSpectrum intensity(const std::string& illuminant, double intensity_cd) const;
    /// Any spectrum of light, the mean over each stratum.
    [[nodiscard]] spectral::GridSpectrum shining(const spectral::Spectrum& spectrum) const;
};

}  // namespace lensproof::scene
