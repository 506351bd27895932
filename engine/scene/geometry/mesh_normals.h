// engine/scene/geometry/mesh_normals.h — normals for meshes whose files give none, or others than are wanted.
#pragma once
#include "engine/scene/geometry/shapes.h"

namespace lensproof::scene {

/// The mesh with normals at its vertices: each corner of a triangle has the mean over those triangles at its place
/// whose own normals lie within `crease_deg` of that triangle's, weighted by the angle that they have there (Thürmer
/// and Wüthrich, "Computing vertex normals from polygonal facets", Journal of Graphics Tools 3, 1998). Places count as
/// the same where their floats are; vertices are split where their corners differ. At 0° every triangle is flat, and so
/// are more than 1000 that meet at one place. Normals that were there are dropped; triangles without an area get none,
/// of length 0. Indices have to be sound.
TriangleMesh with_smooth_normals(const TriangleMesh& mesh, double crease_deg);

}  // namespace lensproof::scene
