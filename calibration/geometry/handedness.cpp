#include "calibration/geometry/handedness.h"

#include <algorithm>
#include <limits>

#include "calibration/geometry/bundle_start.h"
#include "engine/base/input_error.h"

namespace lensproof::calibration {
namespace {

constexpr double kMuchBetter = 0.2;  // of the misfit of undistorted lenses, which distortion makes a few percent

/// Undistorted, of any focal length, in a perspective or a fisheye's projection: the rms distance, px.
double least_misfit(const std::vector<ChartView>& views, int width_px, int height_px) {
    const PointBundle bundle = make_bundle(views, 0.0);
    double least = std::numeric_limits<double>::infinity();
    for (const ModelKind model : {ModelKind::brown_conrady, ModelKind::kannala_brandt}) {
        least = std::min(least, bundle_starts(bundle, model, width_px, height_px, std::nullopt).front().misfit_px);
    }
    return least;
}

}  // namespace

void check_handedness(const std::vector<ChartView>& views, int width_px, int height_px) {
    std::vector<ChartView> mirrored = views;
    for (ChartView& view : mirrored) {
        for (Vec3d& direction : view.directions) {
            direction.z = -direction.z;
        }
    }
    if (least_misfit(mirrored, width_px, height_px) < kMuchBetter * least_misfit(views, width_px, height_px)) {
        throw InputError(
            "the directions are mirrored: one of their angles is counted the other way round (right ascension grows to "
            "the east, azimuth from north by east), or the picture is");
    }
}

}  // namespace lensproof::calibration
