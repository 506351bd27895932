// calibration/geometry/projection_uncertainty.h — how well the fit knows where a point is imaged, over the whole frame.
#pragma once
#include <optional>
#include <vector>

#include "calibration/geometry/fit_geometry.h"

namespace lensproof::calibration {

/// Standard deviation of a projection in its worst direction, px.
///
/// The question is mrcal's (Kogan, "mrcal: projection uncertainty"): a point is fixed in the scene where the camera
/// sees it in this pixel; had the same pictures been taken with other noise, where would the point be imaged? The
/// scene is what the charts fix, so intrinsics and poses move together: to first order, with the covariance Σ of both,
///     p = R_v X + t_v is the point in the camera's frame as seen through view v,
///     δq = ∂q/∂intrinsics δi + ∂q/∂p · mean over v of (∂p/∂pose_v δpose_v),   Var q = J Σ Jᵀ.
/// A focal length that trades against the charts' distance, or a principal point against their rotation, therefore do
/// not count where they cancel. What the model cannot express is not in that; where points are, the residuals show it,
/// and beyond them nothing does but other models. So where some predict the pictures as well ("rivals"), the median
/// distance between where they image the point and where the fit does (`models_px`) is added to the noise's, in
/// squares.
struct UncertaintyMap {
    int columns = 0;
    int rows = 0;
    std::vector<double> x_px;  // of the columns
    std::vector<double> y_px;  // of the rows
    double near_mm = 0.0;      // distance of the near points: the charts' mean; 0 where all views are of directions
    /// Row by row, for points at infinity and at `near_mm`; none where the model images nothing, or nothing is near.
    std::vector<std::optional<double>> far_px;
    std::vector<std::optional<double>> near_px;
    /// What `far_px` has of rivals; empty where there are none.
    std::vector<std::optional<double>> models_px;
    /// Inside the convex hull of the points used: elsewhere the model extrapolates.
    std::vector<bool> covered;
};

/// On a grid of `columns` pixels from corner to corner, and as many rows as make it nearly square. The rivals are fits
/// of the same views.
UncertaintyMap uncertainty_map(const GeometryFit& fit, const std::vector<ChartView>& views, int width_px, int height_px,
                               const std::vector<GeometryFit>& rivals = {}, int columns = 25);

/// The noise's part in one point of the map: infinity, or a distance in mm.
std::optional<double> projection_uncertainty_px(const GeometryFit& fit, const Vec2d& pixel,
                                                std::optional<double> distance_mm = std::nullopt);

/// The rivals' part in it: the median distance of those that image the point, each of which has it where its own poses
/// see it, in the mean over the views. A rival counts by the inverse of its own distance and uncertainty together, so
/// that those which know nothing of the place (polynomials run wild) do not outvote one that does. None without any.
std::optional<double> models_disagreement_px(const GeometryFit& fit, const std::vector<GeometryFit>& rivals,
                                             const Vec2d& pixel, std::optional<double> distance_mm = std::nullopt);

/// Corners of the convex hull, in turn (to single precision); of no point, none.
std::vector<Vec2d> convex_hull(const std::vector<Vec2d>& points);

/// Whether pixels lie inside the convex hull of the views' points.
std::vector<bool> covered_pixels(const std::vector<ChartView>& views, const std::vector<Vec2d>& pixels);

/// The points that `fit` used.
std::vector<ChartView> used_points(const std::vector<ChartView>& views, const GeometryFit& fit);

}  // namespace lensproof::calibration
