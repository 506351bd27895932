// calibration/explain/changed_lens.h — where a lens images a point once it is changed a little, and the derivatives.
#pragma once
#include <Eigen/Core>
#include <memory>
#include <optional>
#include <vector>

#include "calibration/explain/lens_change.h"
#include "engine/base/vec.h"
#include "engine/optics/lens.h"

namespace lensproof::calibration {

/// Where a point is imaged, on the sensor's own axes from its middle: along x and y of lens space, mm.
struct Landing {
    Vec2d image_mm;
    Vec2d stop_slopes;  // of the chief ray at the stop's centre: a start for the next
    Eigen::Matrix<double, 2, Eigen::Dynamic> by_change{};                        // where they were asked for
    Eigen::Matrix<double, 2, 3> by_point = Eigen::Matrix<double, 2, 3>::Zero();  // per mm of the object point
};

/// A lens with some `changes`, at one wavelength. Chief rays from object points through the stop's centre, whatever the
/// rims would cut, traced by the one tracer in double; derivatives are its own, by ceres::Jet, so exact.
///
/// The ray's two slopes s at the stop follow from the object point P, F(s, P, c) = 0, F being by how much the ray that
/// leaves the stop backwards misses P; with the image I(s, c) the derivative by a change c is
///     dI/dc = ∂I/∂c − ∂I/∂s (∂F/∂s)⁻¹ ∂F/∂c
/// (the implicit function theorem), so that no derivative goes through the search for s.
class ChangedLens {
  public:
    /// `values`: of the changes; those of other profiles than `profile` do not count.
    ChangedLens(const optics::Lens& lens, double wavelength_nm, const std::vector<LensChange>& changes,
                const Eigen::VectorXd& values, int profile);
    ~ChangedLens();
    ChangedLens(ChangedLens&&) noexcept;

    /// Nothing where no such ray arrives. `start`: the slopes of a ray near by, if one is known.
    [[nodiscard]] std::optional<Landing> image_of(const Vec3d& object, const std::optional<Vec2d>& start,
                                                  bool with_derivatives) const;

  private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

}  // namespace lensproof::calibration
