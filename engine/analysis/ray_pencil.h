// engine/analysis/ray_pencil.h — the rays infinitely close to a chief ray: where they focus.
#pragma once
#include <array>
#include <optional>

#include "engine/optics/field_bundle.h"

namespace lensproof::analysis {

/// The rays of a bundle next to its chief ray, to first order in their offset: the chief ray behind the last surface,
/// and by how much its point (across the ray) and its direction change with an offset of 1 mm along x and along y.
struct RayPencil {
    Ray<double> chief;                                 // origin on the last surface
    std::array<Vec3d, 2> shift{};                      // mm / mm, perpendicular to the chief ray
    std::array<Vec3d, 2> turn{};                       // rad / mm, perpendicular to the chief ray
    optics::RayStatus status = optics::RayStatus::ok;  // of the chief ray, followed past rims
};

/// Differentiates the laws of transfer and refraction along the chief ray: a shift P and a turn Q of the ray become
/// P + t Q over a distance t; at a surface with the unit normal N and Γ = n' cos i' − n cos i
///     σ = P − d (P·N) / (d·N),   n' Q' = n Q + Γ δN + δΓ N,   P' = σ − d' (σ·d'),
/// where δN is by how much the normal turns over σ, and δΓ keeps Q' perpendicular to d'. In the meridional plane of a
/// centred lens this is Coddington's pair of equations (Welford, Aberrations of Optical Systems, §9.4; Igehy, "Tracing
/// ray differentials", 1999, for the general form), written with heights and angles in place of focal distances: a
/// focus at infinity or on a surface is no special case. A phase W adds δ∇W to the right (n' d' = n d + ∇W + Γ N), an
/// ideal lens turns slopes by its own law. Nothing where the chief ray misses or is totally reflected.
std::optional<RayPencil> ray_pencil(const optics::TraceLens<double>& lens, const optics::FieldBundle& bundle);

/// Where the pencil's rays focus, z in mm from the image plane, positive beyond it; infinite where they leave parallel.
struct AstigmaticFoci {
    double tangential = 0.0;  // of the rays offset along y, in the meridional plane
    double sagittal = 0.0;    // of those offset along x
};

/// The foci. Without symmetry rays offset along x and y alone need not meet the chief ray; its two focal lines remain,
/// det (shift + t turn) = 0, and the tangential one is that whose converging rays are offset rather along y.
AstigmaticFoci astigmatic_foci(const RayPencil& pencil, double image_z);

}  // namespace lensproof::analysis
