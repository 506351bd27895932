// calibration/geometry/fit_geometry.h — a camera model, with its uncertainty, from several views of one chart.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "calibration/geometry/board_shape.h"
#include "calibration/geometry/bundle.h"
#include "calibration/geometry/camera_model.h"
#include "calibration/geometry/planar_pose.h"
#include "engine/base/vec.h"

namespace lensproof::calibration {

struct GeometryOptions {
    ModelKind model = ModelKind::brown_conrady;
    /// Terms k1, k2, … that are fitted (ModelTerms::radial); the others stay 0. Default: all that the model has.
    std::optional<int> radial_terms;
    /// p1 and p2 of the Brown-Conrady models. Off: a lens without decentring, e.g. a render.
    bool fit_tangential = true;
    /// Fits `stretch_y` (radial_model.h): a vertical focal length that is not the horizontal one.
    bool fit_stretch = false;
    /// Holds the principal point at the middle of the picture.
    bool fix_centre = false;
    /// Holds the focal length, which a single view that faces the camera cannot tell.
    std::optional<double> known_focal_px;
    /// Diameter of the chart's discs: their centroids were measured, and perspective and distortion move the centroid
    /// of a disc's image away from the image of its centre (by 0.1 px and more). 0: points (corners).
    double disc_diameter_mm = 0.0;
    /// Fits how far the chart is from flat (board_shape.h), one shape for all views.
    bool fit_board_shape = false;
    /// Points farther from the fit than this many standard deviations (estimated robustly) are left out. Where there
    /// are any, the fit goes through Cauchy's loss first, so that they do not pull at what they are judged by. Outliers
    /// that come by the view (a tenth of its points and more, and the view's own residuals at least twice the others',
    /// or so many only in this view that chance would do it once in 10,000) are no accidents of single points, and
    /// leaving out those beyond a limit would keep what pulls the same way within it: such a view keeps its points, and
    /// all of them count by the inverse square of their own spread. 0: plain least squares over all points.
    double outlier_sigmas = 6.0;
};

struct PointResidual {
    int index = 0;  // into the view's points
    Vec2d measured_minus_model_px;
    bool used = true;
};

struct FittedView {
    Pose pose;
    std::vector<PointResidual> residuals;
    /// Of its squared residuals, 1 but for a view that disagrees as a whole (GeometryOptions::outlier_sigmas).
    double weight = 1.0;
    /// See BundleInformation::View; the covariance is that of the measured residuals.
    std::array<double, 36> pose_covariance{};
    std::vector<double> pose_follows;
};

/// What the views say about the camera. Covariances scale with the residuals' own variance (2 N − parameters degrees
/// of freedom), so a model that does not fit widens its own bounds.
struct GeometryFit {
    CameraModel model;
    /// Row by row, in the order of `parameter_names(model)`; rows of parameters that were held are 0.
    std::vector<double> covariance;
    /// Standard errors of the parameters by what repeats from view to view (BundleInformation::view_covariance), in the
    /// same order; empty for fewer than five views. Larger than those of `covariance` where the residuals of a view are
    /// alike: a chart that bent, a blur to one side, corners that a detector pulls all one way.
    std::vector<double> view_standard_error;
    std::optional<BoardShape> board;  // if it was fitted
    /// The covariance of the intrinsics and the board's heights together, row by row.
    std::vector<double> shared_covariance;
    std::vector<FittedView> views;
    double sigma_px = 0.0;  // standard deviation of one coordinate of one point in a view of weight 1
    double rms_px = 0.0;    // root of the mean of dx² + dy² over the points used (OpenCV's reprojection error)
    int points_used = 0;
    double covered_radius_px = 0.0;  // the farthest point used, from the principal point

    [[nodiscard]] double standard_error(int parameter) const;
};

/// Least squares over intrinsics and poses (Ceres), started from the focal length that explains the views best under
/// an undistorted model; no starting value is needed.
///
/// Throws InputError when there is nothing to fit (no views, fewer points than unknowns, values that are not finite),
/// and when the views leave a parameter undetermined, saying what would help.
GeometryFit fit_geometry(const std::vector<ChartView>& views, int width_px, int height_px,
                         const GeometryOptions& options);

/// The same from a start that is known to be near: another fit of the same views, of any model, or the same model's fit
/// of these and more views (then with the poses of those that are left).
GeometryFit refit_geometry(const std::vector<ChartView>& views, int width_px, int height_px,
                           const GeometryOptions& options, const BundleState& start);

/// A fit as a start for another.
BundleState state_of(const GeometryFit& fit);

}  // namespace lensproof::calibration
