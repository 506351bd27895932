// engine/render/integrators/shading_frame.h — the normal that a surface is shaded with, towards a camera.
//
// Normals that are interpolated over a coarse mesh do not know where its triangles end: near its silhouette they look
// away from the camera, or mirror it into the mesh, and what is left is black. There the normal is bent towards the
// triangle's own, no further than until its mirror image of the direction lies above the triangle (as Iray does: A.
// Keller et al., "The Iray Light Transport Simulation and Rendering System", 2017; and Cycles, with these numbers).
//
// It is bent for the direction towards the camera, of both kinds of paths: so a light path that scatters to the camera
// takes the same normal as the camera path that comes from there, and both see one surface. But what mirrors and smooth
// glass make of a bent normal is found by camera paths alone: light paths that draw directions do not know which
// normals would bend to theirs.
#pragma once
#include <algorithm>
#include <cmath>
#include <optional>

#include "engine/base/basis.h"
#include "engine/scene/scene.h"

namespace lensproof::render {

/// The shading normal as it is bent for light that leaves along `towards` (unit length, from the surface, on either
/// side); nothing where it stays: where `towards` and its mirror image lie on the same side of the triangle's plane,
/// which is then true of that image too.
inline std::optional<Vec3d> bent_normal(const scene::SurfaceHit& hit, const Vec3d& towards) {
    const double side = std::copysign(1.0, dot(towards, hit.geometric_normal));
    const Vec3d geometric = side * hit.geometric_normal;
    const Vec3d shading = side * hit.shading_normal;
    const double wz = dot(towards, geometric);
    if (2.0 * dot(towards, shading) * dot(shading, geometric) > wz) {  // the image's height
        return std::nullopt;
    }
    const Vec3d leaning = shading - dot(shading, geometric) * geometric;
    const double tilt = length(leaning);
    if (!(tilt > 0.0)) {
        return std::nullopt;
    }
    // At ψ from the geometric normal the image's height is w_x sin 2ψ + w_z cos 2ψ.
    const Vec3d across = (1.0 / tilt) * leaning;
    const double wx = dot(towards, across);
    const double least = std::min(0.9 * wz, 0.01);
    const double psi = 0.5 * (std::atan2(wx, wz) + std::acos(least / std::hypot(wx, wz)));
    return side * (std::sin(psi) * across + std::cos(psi) * geometric);
}

/// Turns `frame`, whose z is the shading normal, where that has to be bent; whether it has to be.
inline bool bend(Basis& frame, const scene::SurfaceHit& hit, const Vec3d& towards) {
    if (hit.shading_normal == hit.geometric_normal) {
        return false;
    }
    const std::optional<Vec3d> bent = bent_normal(hit, towards);
    if (bent) {
        const Vec3d across = hit.tangent - dot(hit.tangent, *bent) * *bent;
        const double size = length(across);
        frame = size > 1e-6 ? Basis(*bent, (1.0 / size) * across) : Basis(*bent);
    }
    return bent.has_value();
}

}  // namespace lensproof::render
