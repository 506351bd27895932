// engine/optics/chief_ray.h — real chief rays: through the centre of the stop, found from the stop outwards.
#pragma once
#include <optional>
#include <vector>

#include "engine/optics/lens.h"

namespace lensproof::optics {

/// A real ray through the stop's centre. Of a rotationally symmetric lens it lies in the meridional plane x = 0. Lens
/// space, mm, radians.
struct ChiefRay {
    double field_angle;                // of the incoming ray from the axis, positive towards +y
    Ray<double> front;                 // incoming: a point on the first surface and the direction towards it
    double image_height;               // y where it meets the sensor's plane
    RayStatus status = RayStatus::ok;  // or clipped by a rim that it was followed beyond (Rims::follow)
    int surface = -1;                  // the first such rim, counted from 0; else −1
    Ray<double> rear{};                // outgoing: a point on the last surface and the direction from it
    Vec2d image_point{};               // where it meets the sensor's plane; y is `image_height`
};

/// The chief rays of a lens at one wavelength. Of a rotationally symmetric lens they are a one-parameter family: the
/// angle u under which the ray crosses the axis at the stop's centre (in the medium behind it, where the stop is a
/// glass surface). Aiming from the front through the paraxial entrance pupil stops converging for a fisheye, whose
/// pupil moves by more than its own diameter; from the stop the map is one to one over the whole field, and a root of
/// it is found to the last digits (TOMS 748; Alefeld, Potra, Shi 1995).
///
/// Where surfaces are tilted or decentred, the stop's centre is its displaced vertex and the ray is aimed in two angles
/// from there, by Newton's method along a path of fields that starts at the stop's axis; it reaches 1e-12 or there is
/// no ray. The object keeps to the plane x = 0, the ray's place does not.
class ChiefRays {
  public:
    /// With Rims::follow the rays go on beyond the rims, as far as they meet every surface.
    ChiefRays(const Lens& lens, double wavelength_nm, Rims rims = Rims::clip);

    /// The chief ray that leaves the stop's centre at `stop_angle` from the axis in the plane x = 0, or nothing where a
    /// rim clips it or it cannot pass.
    [[nodiscard]] std::optional<ChiefRay> from_stop(double stop_angle) const;

    /// The chief ray of an object at infinity in direction `field_angle`, negative ones included, or nothing beyond the
    /// field. On the axis of a symmetric lens its numbers are exactly 0.
    [[nodiscard]] std::optional<ChiefRay> at_field(double field_angle) const;

    /// The chief ray from an object point in front of the lens (z < 0), or nothing. Of a symmetric lens x has to be 0;
    /// y ≤ 0 images to heights ≥ 0.
    [[nodiscard]] std::optional<ChiefRay> from_point(const Vec3d& object) const;
    [[nodiscard]] std::optional<ChiefRay> from_point(double y, double z) const { return from_point({0.0, y, z}); }

    /// The last field angle whose chief ray passes every rim, or goes on beyond them (Rims::follow) as far as the field
    /// grows with the stop angle: far beyond the rims surfaces may bend it back.
    [[nodiscard]] double largest_field() const { return largest_field_; }

  private:
    /// Where a ray that leaves the stop's centre in this direction came in, run backwards: the ray bends at its vertex,
    /// where the stop is a glass surface, an ideal lens or a grating.
    [[nodiscard]] std::optional<Vec3d> outwards_from_stop(const Vec3d& direction) const;
    [[nodiscard]] std::optional<ChiefRay> through_stop(const Vec3d& direction, Rims rims) const;
    template <class Residual>
    [[nodiscard]] std::optional<ChiefRay> solve(const Residual& residual) const;
    template <class Residual>
    [[nodiscard]] std::optional<ChiefRay> aim(const Residual& residual) const;
    [[nodiscard]] double end_of_family() const;
    [[nodiscard]] double find_largest_field() const;

    TraceLens<double> whole_;
    TraceLens<double> front_;  // the surfaces before the stop
    TraceLens<double> stop_;   // it alone
    TraceLens<double> rear_;   // those behind it
    Rims rims_ = Rims::clip;
    bool is_symmetric_ = true;
    bool is_thin_stop_ = false;
    Vec3d stop_centre_;
    Vec3d stop_normal_;          // towards the sensor
    double stop_ratio_ = 1.0;    // index behind the stop over that before it
    double stop_heading_ = 1.0;  // the sign of the former
    double largest_stop_angle_ = 0.0;
    double largest_field_ = 0.0;
};

}  // namespace lensproof::optics
