// engine/analysis/ghost_mesh.h — a distant light's ghost drawn onto a sensor: a mesh over the front element, each
// triangle's light spread over the triangle on the sensor to which the lens maps it.
#pragma once
#include <functional>

#include "engine/analysis/ghost_region.h"
#include "engine/analysis/light_raster.h"

namespace lensproof::analysis {

struct MeshSettings {
    double energy_error = 2e-3;  // of the ghost's energy
    double place_error = 0.0;    // mm on the sensor: half a pixel, say
};

/// Energies as fractions of the light that enters the entrance pupil.
struct MeshedGhost {
    double energy = 0.0;        // inside the image circle, as in GhostLight
    double energy_bound = 0.0;  // what the rims' chords cut off or add is estimated not to exceed
    int rays = 0;
    int triangles = 0;
};

/// What is to be done with each triangle: its corners on the sensor's plane, and its energy.
using DrawTriangle = std::function<void(const std::array<Vec2d, 3>& corners, double energy)>;

/// Meshes the part of the front element from which the ghost's light lands. `region` is where to begin; where light
/// lands at the mesh's border it grows, so that a region found at another wavelength serves too.
///
/// The mesh is a quadtree. A cell's middle and the middles of its sides are traced too. Where they land farther from
/// the middle of their neighbours than four times `place_error`, it is divided: so it is refined where the map folds,
/// and light is drawn within `place_error` of where it lands, for the triangles have those middles for corners and
/// halving leaves a quarter of the error. A triangle at a rim is cut along the chord between the points where its sides
/// meet the rim, which are found by tracing; between them a rim bulges by what the margins' second difference tells,
/// and cells are divided until the areas of all these bulges make less than `energy_error` of the energy.
MeshedGhost mesh_ghost(const GhostScene& scene, const optics::GhostPath& path, const GhostRegion& region,
                       const MeshSettings& settings, const DrawTriangle& draw);

}  // namespace lensproof::analysis
