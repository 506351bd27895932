// engine/analysis/wavefront.h — optical path differences of a field's rays against the real exit pupil's sphere.
#pragma once
#include <optional>
#include <span>
#include <vector>

#include "engine/analysis/beam_outline.h"
#include "engine/optics/field_bundle.h"

namespace lensproof::analysis {

/// The sphere on which a field's optical paths are compared: around an image point, through the exit pupil. Lens space.
struct ReferenceSphere {
    Vec3d centre;  // the image point, mm
    double curvature =
        0.0;  // 1/mm: 1 / (distance from the exit pupil to the centre, along the chief ray); positive for
              // a pupil in front of the image, negative behind it, 0 for one at infinity (telecentric)
};

/// The sphere of `bundle` around the point where its chief ray, followed beyond rims, meets the image plane. Its radius
/// reaches to the exit pupil, which is where that ray crosses the axis in image space; on the axis, and for a lens with
/// tilted or decentred surfaces, the paraxial exit pupil. Nothing where the chief ray does not reach the image plane.
std::optional<ReferenceSphere> reference_sphere(const optics::TraceLens<double>& lens,
                                                const optics::FieldBundle& bundle);

/// Where a ray stands to the reference sphere.
struct SphereMeeting {
    double optical_path;  // from the ray's origin to the sphere, plus the sphere's radius, mm
    Vec3d towards;        // optical direction cosines, from the ray's point on the sphere towards the centre
};

/// With f = p + (d·(C − p)) d the ray's foot, the point next to the centre C, and q = f − C, the sphere lies
///     R − s,   s = c q² / (1 + √(1 − c² q²))
/// in front of the foot, so that the radius R itself, which is the same for all rays, never enters, and a telecentric
/// pupil (c = 0) loses no digits. Nothing where the ray passes the sphere by, or did not get through the lens.
std::optional<SphereMeeting> meet_sphere(const optics::TraceLens<double>& lens, const ReferenceSphere& sphere,
                                         const optics::TracedRay<double>& ray);

/// A ray of the beam on the reference sphere.
struct WavefrontRay {
    Vec2d offset;         // mm across the incoming chief ray, as FieldBundle takes it
    double weight = 0.0;  // mm², of the incoming beam's cross-section
    double opd_mm = 0.0;  // [chief ray] − [this ray], up to the sphere
    Vec2d
        pupil;  // optical cosines n x, n y from the ray's point on the sphere to the image point, less the chief ray's
    double pupil_z = 0.0;  // the same of the z cosine
};

/// The wavefront of one field at one wavelength.
///
/// A path difference is positive where the wavefront is ahead of the reference sphere, nearer to the image, since the
/// ray's path up to the sphere is the shorter one: W = [chief ray] − [ray] (Welford, Aberrations of Optical Systems,
/// 7.2; so rayoptics and OpticStudio). Undercorrected spherical aberration has W040 > 0, as S1 has.
struct Wavefront {
    double wavelength_nm = 0.0;
    ReferenceSphere sphere;
    std::vector<WavefrontRay> rays;
    double lost_weight = 0.0;  // mm², of nodes whose ray did not reach the sphere
};

/// Traces `bundle` at `nodes`, which the caller took inside the beam (`region_quadrature`): rays are followed beyond
/// rims, so that those on a rim are not lost to rounding. All path differences are sums over the lens alone, whatever
/// the object's distance (FieldBundle). `lens` may be at another wavelength than `sphere` was made for. Where the chief
/// ray does not get through at this wavelength, the mean stands for its path.
Wavefront wavefront(const optics::TraceLens<double>& lens, double wavelength_nm, const optics::FieldBundle& bundle,
                    const ReferenceSphere& sphere, std::span<const optics::RegionNode> nodes);

/// Root mean squares over the beam's cross-section, in waves; the mean (piston) is always taken out.
struct WavefrontErrors {
    double rms = 0.0;                // against the sphere as it is: tilt and defocus count
    double rms_without_tilt = 0.0;   // against the best sphere with its centre in the same plane
    double rms_without_focus = 0.0;  // against the best sphere with its centre anywhere
    double peak_to_valley = 0.0;     // over the nodes
    Vec3d best_centre;               // of that last sphere, less the given one's, mm
};

/// Moving the sphere's centre by δ changes W by −δ·(u − u of the chief ray), with u the unit vectors towards the
/// centre; so the best centres are linear least squares, exact to first order in δ.
WavefrontErrors wavefront_errors(const Wavefront& wavefront);

}  // namespace lensproof::analysis
