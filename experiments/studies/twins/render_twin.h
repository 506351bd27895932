// experiments/studies/twins/render_twin.h — a photo rendered again, and what differs.
#pragma once
#include <string>
#include <vector>

#include "calibration/measure/measure.h"
#include "calibration/twins/pixel_account.h"
#include "calibration/twins/point_account.h"
#include "engine/base/json_archive.h"
#include "engine/render/camera/camera.h"
#include "experiments/findings/study.h"
#include "experiments/studies/cameras/residual_findings.h"
#include "experiments/studies/twins/twin_set.h"

namespace lensproof::studies {

/// A photo beside its twin.
struct Twin {
    int width = 0;  // px, of the photo
    int height = 0;
    std::vector<calibration::TwinPoint> points;  // found in both
    calibration::PixelAccount pixels;
    // To be looked at: JPEG; empty where too few points are found in the twin.
    std::string photo{};
    std::string render{};      // in the photo's light
    std::string difference{};  // photo less twin
    std::vector<FarPoint> far_points{};
};

void fields(JsonArchive& json, Twin& twin);

/// From where on a difference is as red or as blue as it gets, in fractions of the chart's contrast.
inline constexpr double kShownDifference = 0.25;

/// Renders the view of that number through the fitted camera, looks for the chart's points in it from where they are
/// predicted, and accounts for the difference.
Twin render_twin(const TwinSettings& settings, const FittedTwin& fitted, const calibration::Profile& profile,
                 const PhotoSet& photos, const calibration::Picture& photo, const render::Camera& camera,
                 std::size_t view, const findings::RunSettings& run, const std::function<void(double)>& progress);

/// The camera that twins are rendered by.
render::CameraSettings camera_settings(const TwinSettings& settings, const FittedTwin& fitted);

}  // namespace lensproof::studies
