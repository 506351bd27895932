#include "calibration/measure/measure_lines.h"

#include <fmt/format.h>

#include <cmath>

#include "calibration/lines/line_distortion.h"

namespace lensproof::calibration {

Vec2d measure_lines(Profile& profile, const Observations& seen) {
    for (const PictureObservation& picture : seen.pictures) {
        profile.scene_lines.insert(profile.scene_lines.end(), picture.scene_lines.begin(), picture.scene_lines.end());
    }
    LineDistortion found;
    try {
        found = fit_line_distortion(profile.scene_lines, seen.width, seen.height);
    } catch (const InputError& e) {
        throw InputError(profile.name + ": " + e.what());
    }
    profile.terms[kLineDistortionTerms()] = {found.names, found.values, found.covariance};
    profile.curves[kQuantities.distortion.key()] = found.distortion;
    profile.not_measured[part::kGeometry] = "straight lines tell the distortion, and neither a focal length nor angles";
    profile.warnings.push_back(
        "what is not straight in the world, where most of the long edges bend alike, is taken for distortion");
    if (!found.centre_is_told) {
        profile.warnings.push_back(fmt::format(
            "the lines do not tell the optical centre: it is taken to be near the picture's middle, within {:.3g} px "
            "(one standard error)",
            kCentrePrior * half_diagonal_px(profile)));
    }
    return found.centre_px;
}

}  // namespace lensproof::calibration
