// calibration/explain/lens_residuals.h — by how much a changed lens misses what was seen, in standard deviations.
#pragma once
#include <Eigen/Core>
#include <vector>

#include "calibration/explain/lens_change.h"
#include "calibration/explain/seen_points.h"
#include "engine/optics/lens.h"

namespace lensproof::calibration {

/// A lens, where each profile found it (focused on its charts), and what may be otherwise in it.
struct ExplainedLens {
    std::vector<optics::Lens> focused;  // one a profile
    std::vector<LensChange> changes;
    /// Two wavelengths for red, green and blue each, of equal weight.
    std::array<std::array<double, 2>, 3> wavelengths_nm{};
    double entrance_pupil_z = 0.0;  // where the camera's frame has its origin, to begin with
};

/// `focus_mm`: the object's distance from the first surface; of none, the charts' mean. Throws InputError for kinds
/// that do not exist and objects that the lens cannot focus on.
ExplainedLens explained_lens(const optics::Lens& lens, const SeenPoints& seen, const std::vector<std::string>& free,
                             const std::optional<double>& focus_mm);

inline constexpr int kPoseUnknowns = 6;

/// The changes, and where the charts stood.
struct LensState {
    Eigen::VectorXd changes;
    std::vector<PoseParameters> poses;  // of the views
};

/// The unchanged lens and the profiles' poses.
LensState start_of(const ExplainedLens& lens, const SeenPoints& seen);

/// Measured minus predicted: of each view's points x and y, then of each shift seven terms; in standard deviations.
struct LensResiduals {
    Eigen::VectorXd values;
    Eigen::MatrixXd by_change;  // empty where they were not asked for
    Eigen::MatrixXd by_pose;    // six columns a view
};

/// Nothing where a point is not imaged. Rays are looked for from those of the last call.
class ResidualTracer {
  public:
    ResidualTracer(const ExplainedLens& lens, const SeenPoints& seen) : lens_(lens), seen_(seen) {}

    [[nodiscard]] std::optional<LensResiduals> residuals(const LensState& state, bool with_derivatives);

    /// Whether each view's points are imaged.
    [[nodiscard]] std::vector<std::vector<bool>> imaged(const LensState& state);

  private:
    struct Image;
    class Rays;

    // Each fills its rows of the residuals; false where a point is not imaged.
    bool add_points(const Rays& rays, const LensState& state, bool with_derivatives, LensResiduals& result);
    [[nodiscard]] bool add_shifts(const Rays& rays, bool with_derivatives, LensResiduals& result) const;

    const ExplainedLens& lens_;
    const SeenPoints& seen_;
    std::vector<std::array<std::optional<Vec2d>, 2>> slopes_;  // of green's rays to the points
};

/// Leaves out the points that the lens does not image, and the views that have few others. Returns how many points
/// that were.
int keep_imaged(const ExplainedLens& lens, SeenPoints& seen);

}  // namespace lensproof::calibration
