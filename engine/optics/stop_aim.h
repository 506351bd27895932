// engine/optics/stop_aim.h — rays from where light comes from through a given point of the stop.
#pragma once
#include <optional>
#include <vector>

#include "engine/optics/trace.h"

namespace lensproof::optics {

/// Where light comes from, in lens space: a point (mm) or, from far off, the direction (of unit length) that it travels
/// in.
struct RayOrigin {
    Vec3d at;
    bool is_far = false;
};

/// A ray at a point of the stop, from an origin.
struct AimedRay {
    Ray<double> front;           // into the lens: its point on the first surface and its direction to there
    Vec3d direction;             // at the stop, in the stop's own frame
    double transmittance = 0.0;  // from the scene to the stop
    double optical_path = 0.0;   // to the stop from the origin, or the plane across far light through lens space's, mm
    /// How much of the origin's beam goes through a mm² of the stop's plane: of far light mm² across it, of a near
    /// point's sr.
    double beam_per_mm2 = 0.0;
};

/// A ray that came forward to the stop's plane, in the stop's own frame.
struct RayAtStop {
    Vec3d front;  // where it met the first surface, in lens space
    Vec2d point;  // mm from the stop's middle, which may lie beyond its opening
    Vec3d direction;
    double transmittance = 0.0;
};

/// A lens at one wavelength, parted at its stop, which has to be a plane in one medium (`has_plane_stop`).
///
/// Rays are aimed backwards from the stop, where the map to the scene is one to one over the whole field even of a
/// fisheye, by Newton's method in the two direction cosines p there; so the point of the stop is met exactly, and the
/// origin within 1e-9 rad. With P the direction cosines of the incoming light across itself and n the stop's index, a
/// beam of one direction spreads over the stop as d(offset)/d(point) = n² |∂p/∂P|, and that of a point at the distance
/// R as dω/d(point) = n² |∂p/∂P| / R², P then being against the direction to it: both are mixed second derivatives of
/// one characteristic function (Luneburg, Mathematical Theory of Optics, §§ 17–19).
class StopAim {
  public:
    StopAim(const TraceLens<double>& lens, int stop_index);

    /// Through `point` of the stop's plane, mm from the stop's middle in its own frame. `near`: a direction at the stop
    /// to begin with, from `aim` at another wavelength. Nothing where a rim before the stop is in the way.
    [[nodiscard]] std::optional<AimedRay> aim(const RayOrigin& origin, const Vec2d& point,
                                              const Vec3d* near = nullptr) const;

    /// A ray from the scene as far as the stop. Nothing where a rim before the stop is in the way.
    [[nodiscard]] std::optional<RayAtStop> to_stop(const Ray<double>& ray) const;

    /// A ray on from `point` along `direction`, both in the stop's frame, through the rest of the lens.
    [[nodiscard]] TracedRay<double> onwards(const Vec2d& point, const Vec3d& direction) const;

    [[nodiscard]] double semi_diameter() const { return semi_diameter_; }  // of the stop, mm
    [[nodiscard]] double index() const { return index_; }                  // of the medium that it stands in
    [[nodiscard]] double image_z() const { return rear_.image_z; }

  private:
    /// Of a chief ray, from the stop's middle.
    struct Chief {
        double field_angle = 0.0;  // outside
        double sine = 0.0;         // of its angle at the stop
    };
    struct Outside;

    [[nodiscard]] Vec3d in_lens(const Vec3d& own) const;
    [[nodiscard]] std::optional<Ray<double>> outwards(const Vec2d& point, const Vec2d& cosines) const;
    [[nodiscard]] std::optional<Outside> outside(const RayOrigin& origin, const Vec2d& point,
                                                 const Vec2d& cosines) const;
    [[nodiscard]] Vec2d first_guess(const RayOrigin& origin, const Vec2d& point) const;

    TraceLens<double> front_;  // the surfaces before the stop
    TraceLens<double> rear_;   // those behind it
    Vec3d middle_;             // of the stop
    SpecialSurface<double> frame_;
    double semi_diameter_ = 0.0;
    double index_ = 1.0;
    std::vector<Chief> chiefs_;   // by rising field angle
    double cosine_per_mm_ = 0.0;  // by which p changes over the stop in light from far off, near the axis
};

/// Whether the stop is a plane of its own, with one medium on both sides.
bool has_plane_stop(const TraceLens<double>& lens, int stop_index);

}  // namespace lensproof::optics
