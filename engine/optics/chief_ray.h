// engine/optics/chief_ray.h — real chief rays: through the centre of the stop, found from the stop outwards.
#pragma once
#include <optional>
#include <vector>

#include "engine/optics/lens.h"

namespace lensproof {

/// A real ray through the stop's centre, in the meridional plane x = 0. Lens space, mm, radians.
struct ChiefRay {
    double field_angle;                // of the incoming ray from the axis, positive towards +y
    Ray<double> front;                 // incoming: a point on the first surface and the direction towards it
    double image_height;               // y where it meets the sensor's plane
    RayStatus status = RayStatus::ok;  // or clipped by a rim that it was followed beyond (Rims::follow)
    int surface = -1;                  // the first such rim, counted from 0; else −1
};

/// The chief rays of a lens at one wavelength, as a one-parameter family: the angle u under which the ray crosses the
/// axis at the stop's centre (in the medium behind it, where the stop is a glass surface). Aiming from the front
/// through the paraxial entrance pupil stops converging for a fisheye, whose pupil moves by more than its own diameter;
/// from the stop the map is one to one over the whole field.
class ChiefRays {
  public:
    /// With Rims::follow the rays go on beyond the rims, as far as they meet every surface.
    ChiefRays(const Lens& lens, double wavelength_nm, Rims rims = Rims::clip);

    /// The chief ray that crosses the stop's centre at `stop_angle`, or nothing where a rim clips it or it cannot pass.
    [[nodiscard]] std::optional<ChiefRay> from_stop(double stop_angle) const;

    /// The chief ray of an object at infinity in direction `field_angle` (≥ 0), or nothing beyond the field.
    [[nodiscard]] std::optional<ChiefRay> at_field(double field_angle) const;

    /// The chief ray from the object point at height `y` (≤ 0 images to heights ≥ 0) and position `z` < 0, or nothing.
    [[nodiscard]] std::optional<ChiefRay> from_point(double y, double z) const;

    /// The last field angle whose chief ray passes every rim, or goes on beyond them (Rims::follow).
    [[nodiscard]] double largest_field() const { return largest_field_; }

  private:
    template <class Residual>
    [[nodiscard]] std::optional<ChiefRay> solve(const Residual& residual) const;

    TraceLens<double> whole_;
    TraceLens<double> front_;  // the surfaces before the stop
    TraceLens<double> rear_;   // those behind it
    Rims rims_ = Rims::clip;
    double stop_z_ = 0.0;
    double stop_ratio_ = 1.0;  // index behind the stop over that before it
    double largest_stop_angle_ = 0.0;
    double largest_field_ = 0.0;
};

}  // namespace lensproof
