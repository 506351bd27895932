// engine/render/camera_end.h — a camera as the end of light paths: rays drawn into it, and where on the film they end.
#pragma once
#include <array>
#include <optional>
#include <variant>
#include <vector>

#include "engine/optics/packet/spectral_lens.h"
#include "engine/pupil/entrance_map.h"
#include "engine/render/ideal_camera.h"
#include "engine/render/path_weight.h"
#include "engine/render/sampling/sensor.h"
#include "engine/render/shared_rays.h"
#include "engine/scene/pose.h"
#include "engine/spectral/spectral_sample.h"

namespace lensproof::render {

/// A lens, at the strata of the scene's grid. All that it refers to outlives it.
struct LensEntrance {
    const optics::SpectralLens<double>* lens = nullptr;
    const pupil::PupilMap* pupil = nullptr;   // of the same band, as camera paths draw from it
    const pupil::EntranceMap* map = nullptr;  // for far light, with a large defensive share: where near points' light
                                              // enters lies a little beside its regions
    pupil::BoundingSphere front;
};
/// An ideal camera, a stratum each.
struct IdealEntrance {
    const std::vector<GaussianCamera>* at = nullptr;
};

/// Where light comes from on its way into the camera: a point (mm) or, from far off, the direction (of unit length)
/// that it travels in; world frame.
struct LightOrigin {
    Vec3d at;
    bool is_far = false;
};

/// A ray into the camera that was drawn for light from an origin.
struct RayIn {
    Ray<double> ray;      // lens space, towards the camera
    Vec3d direction;      // the same in the world
    Vec3d end;            // world: the way is free if nothing stands between the origin and this
    PathDensity density;  // per solid angle; of far light per mm² across it
};

/// What becomes of a ray into the camera at each of a path's wavelengths.
struct FilmArrival {
    std::array<Vec2d, spectral::kWavelengthsPerPath> at_px;
    /// The power that arrives on the film over that of the ray's etendue outside: the transmittance of a lens. 0: the
    /// ray does not arrive.
    std::array<double, spectral::kWavelengthsPerPath> share{};
    /// The density with which a camera path with this wavelength for its hero draws the ray: per etendue outside, times
    /// a pixel's area.
    std::array<double, spectral::kWavelengthsPerPath> drawn{};

    [[nodiscard]] bool is_dark() const;
    /// That of camera paths which carry `wavelength` and end in its pixel, whichever of their wavelengths is the hero.
    [[nodiscard]] double shared_density(std::size_t wavelength) const;
};

/// A camera in the world.
///
/// Through a lens, rays are drawn over its front (EntranceMap) and traced forward, each wavelength by itself. Ideal
/// cameras are entered through their pupil: of the map (h, s) → (height, slope) before the lens (GaussianCamera), whose
/// determinant is D, light of a scene point at the distance Δ behind `object_z` (a negative number) that crosses the
/// pupil at h has s = (p − (h_h + Δ s_h) h) / (h_s + Δ s_s), p being the point's height, so that a density 1/A of h is
/// ((h_s + Δ s_s) / D)² / (A cos³ θ) per solid angle. A film point x and h, dx dh = Z² dh ds with Z from film to pupil,
/// fill the etendue D² cos⁴ θ dh ds outside; what camera paths count, cos⁴ θ' / Z² per dx dh at θ' on the film, is
/// (cos θ' / cos θ)⁴ / D² of it. A pinhole is entered through its centre and counts for all of its pupil.
struct CameraEnd {
    std::variant<LensEntrance, IdealEntrance> entrance;
    scene::RigidMotion camera_to_world;  // of the frame of pose.h
    Sensor sensor;

    /// Draws a ray for a path's light. Nothing where none may arrive, or from where rays cannot be drawn: points inside
    /// the sphere about a lens's front, or behind an ideal camera's front.
    [[nodiscard]] std::optional<RayIn> draw(const LightOrigin& from, const spectral::PathWavelengths& path, double u,
                                            double v) const;

    /// The density with which `draw` does so for the ray that leaves the camera as `outwards` (lens space).
    [[nodiscard]] PathDensity density(const LightOrigin& from, const Ray<double>& outwards,
                                      const spectral::PathWavelengths& path) const;

    /// Brings a ray (lens space, towards the camera) to the film.
    [[nodiscard]] FilmArrival arrive(const Ray<double>& ray, const spectral::PathWavelengths& path) const;

    /// For one light path to each camera path of each pixel: `drawn` is the camera's density times a pixel's area.
    [[nodiscard]] EntranceRatio ratio(const PathDensity& entrance, const PathDensity& drawn) const;
    [[nodiscard]] double film_area_mm2() const;
};

}  // namespace lensproof::render
