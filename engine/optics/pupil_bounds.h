// engine/optics/pupil_bounds.h — through which part of the rear element light reaches each sensor position.
#pragma once
#include <numbers>
#include <vector>

#include "engine/optics/trace.h"

namespace lensproof {

/// An ellipse in the plane of the rear element's rim, in the frame in which the sensor point lies at (0, r), r ≥ 0; mm.
struct PupilEllipse {
    double centre_y = 0.0;
    double semi_axis_x = 0.0;
    double semi_axis_y = 0.0;

    [[nodiscard]] double area() const { return std::numbers::pi * semi_axis_x * semi_axis_y; }

    /// The point that (u, v) in the unit square maps to, evenly over the ellipse (Shirley & Chiu, J. Graphics Tools
    /// 2(3), 1997).
    [[nodiscard]] Vec2d warped(double u, double v) const;
};

/// For a rotationally symmetric lens (its stop's blades aside, whose corners' circle is taken): ellipses that hold
/// every passing path, by the sensor point's distance from the axis (after Steinert et al. 2011, "pixel pupil
/// sampling", and Kolb, Mitchell, Hanrahan 1995).
///
/// Each ellipse holds the outlines of the passing region found at both ends and the middle of its range of radii, at
/// every lens given (one a wavelength), and 0.3 % more. An outline is found by bisection from a passing point, so the
/// region is taken to be star-shaped about its middle. Where a grid over the element meets no path, the ellipse is the
/// whole element, so that nothing is lost. A test holds the film irradiance against that of the whole element.
class PupilBounds {
  public:
    PupilBounds(std::vector<TraceLens<double>> lenses, double largest_radius_mm, int ranges = 64);

    /// The whole rear element for every sensor point: the baseline that bounds are judged against, and what a lens
    /// without rotational symmetry is sampled by. Sensor points lie within `sensor_radius_mm` of the axis, which counts
    /// where the rear surface is tilted.
    static PupilBounds whole_element(const TraceLens<double>& lens, double sensor_radius_mm = 0.0);

    [[nodiscard]] const PupilEllipse& at(double radius_mm) const {
        const auto range = static_cast<std::size_t>(radius_mm * ranges_per_mm_);
        return ellipses_[range < ellipses_.size() ? range : ellipses_.size() - 1];
    }

    /// z of the plane that the ellipses lie in.
    [[nodiscard]] double plane_z() const { return plane_z_; }

  private:
    PupilBounds() = default;

    std::vector<PupilEllipse> ellipses_;
    double ranges_per_mm_ = 0.0;
    double plane_z_ = 0.0;
};

}  // namespace lensproof
