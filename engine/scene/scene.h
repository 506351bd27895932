// engine/scene/scene.h — all that light meets: surfaces, what they are made of, and the lights.
#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/scene/geometry/geometry.h"
#include "engine/scene/light/light.h"
#include "engine/scene/material/material.h"
#include "engine/spectral/spectral_sample.h"

namespace lensproof::scene {

/// A scene as renderers take it. World frame, mm; everything spectral is tabulated on `grid`.
struct Scene {
    spectral::SpectralGrid grid;
    std::unique_ptr<const SceneGeometry> geometry;  // at a fixed place: `lights` refers to it
    std::vector<Material> materials;                // as the geometry's objects name them
    /// What light loses inside bodies of a material, 1/mm; a material each, or none at all.
    std::vector<std::optional<spectral::GridSpectrum>> absorption;
    Lights lights;
};

}  // namespace lensproof::scene
