// calibration/geometry/cross_validation.h — how well a fit predicts pictures that it has not seen.
#pragma once
#include <optional>
#include <vector>

#include "calibration/geometry/fit_geometry.h"

namespace lensproof::calibration {

/// What a fit to the first half of the views and one to the second disagree about. (Every other view, so that both
/// halves have seen the whole series.) Neither knows where the charts stood, so a rotation between the two cameras
/// that makes the mappings most alike is taken out first, as mrcal's show-projection-diff does.
struct HalvesDifference {
    double rms_px = 0.0;      // over the covered frame
    double largest_px = 0.0;  // over the covered frame
};

/// What was left out is predicted by intrinsics (and board) from the rest; its own points tell the pose alone.
struct CrossValidation {
    int folds = 0;                            // each view is in one; a single view is split by its points
    double held_out_rms_px = 0.0;             // root of the mean of the weighted dx² + dy²
    std::vector<double> held_out_squared_px;  // weighted mean of dx² + dy², by view (of four points or more)
    std::optional<HalvesDifference> halves;   // none for fewer than four views, or where a half determines no camera
};

/// Starts from `fit`, whose outliers stay out. Of 20 views and more the two halves are the folds; of fewer, single
/// views or groups of them are five folds. Throws InputError where a fold's rest does not determine the model.
CrossValidation cross_validate(const std::vector<ChartView>& views, int width_px, int height_px,
                               const GeometryOptions& options, const GeometryFit& fit);

/// The difference of two mappings over the covered pixels of a grid, after the best rotation. None when either images
/// too little of it.
std::optional<HalvesDifference> mapping_difference(const CameraModel& a, const CameraModel& b,
                                                   const std::vector<Vec2d>& pixels);

}  // namespace lensproof::calibration
