#include "experiments/studies/closed_loop.h"

#include <fmt/format.h>

#include "calibration/profile/curve_difference.h"
#include "engine/base/infinity.h"

namespace lensproof::studies {

namespace {

struct Quantity {
    const char* curve;  // by which the self-test knows it
    const char* id;
    const char* label;
    const char* unit;
    double scale;  // from the curve's unit to the check's
    bool use_rms;
};

runner::Check make_check(const Quantity& quantity, const calibration::Profile& measured,
                         const std::optional<calibration::CurveDifference>& difference, double limit) {
    runner::Check check{.id = quantity.id, .label = quantity.label, .unit = quantity.unit, .limit = limit};
    if (const calibration::CurveFloor* floor = calibration::floor_of(measured.self_test, quantity.curve)) {
        check.floor = quantity.scale * (quantity.use_rms ? floor->rms : floor->largest);
    }
    if (!difference) {
        check.value = kNaN;
        check.explanation = "The curve was not measured.";
        return check;
    }
    check.value = quantity.scale * (quantity.use_rms ? difference->rms : difference->largest);
    check.sigma = quantity.scale * (quantity.use_rms ? difference->rms_sigma : difference->largest_sigma);
    check.explanation =
        quantity.use_rms
            ? fmt::format(
                  "Measured minus traced, over the picture's area as far as the chart's points reach: image "
                  "heights from 0 to {:.2f} of the half-diagonal.",
                  difference->curve.covered_image_height)
            : fmt::format("Largest difference, measured minus traced; it stands at image height {:.2f} of 0 to {:.2f}.",
                          difference->largest_at, difference->curve.covered_image_height);
    return check;
}

}  // namespace

std::vector<runner::Check> closed_loop_checks(const std::string& subject, const std::string& label,
                                              const calibration::Profile& measured, const calibration::Profile& traced,
                                              const runner::ClosedLoopLimits& limits) {
    std::vector<runner::Check> checks;
    const auto radial = calibration::radial_difference_px(measured, traced);
    if (limits.distortion_rms_px) {
        checks.push_back(make_check({"radial_px", "distortion-rms", "image position, rms", "px", 1.0, true}, measured,
                                    radial, *limits.distortion_rms_px));
    }
    if (limits.distortion_largest_px) {
        checks.push_back(make_check({"radial_px", "distortion-largest", "image position, largest", "px", 1.0, false},
                                    measured, radial, *limits.distortion_largest_px));
    }
    if (limits.vignetting_percent) {
        checks.push_back(make_check({"vignetting_G", "vignetting", "relative illumination, largest", "%", 100.0, false},
                                    measured, calibration::difference(measured, traced, "vignetting_G"),
                                    *limits.vignetting_percent));
    }
    if (limits.chromatic_shift_px) {
        checks.push_back(make_check(
            {"chromatic_shift_R_px", "chromatic-shift-R", "chromatic shift of red, largest", "px", 1.0, false},
            measured, calibration::difference(measured, traced, "chromatic_shift_R_px"), *limits.chromatic_shift_px));
        checks.push_back(make_check(
            {"chromatic_shift_B_px", "chromatic-shift-B", "chromatic shift of blue, largest", "px", 1.0, false},
            measured, calibration::difference(measured, traced, "chromatic_shift_B_px"), *limits.chromatic_shift_px));
    }
    for (runner::Check& check : checks) {
        check.id = subject + "-" + check.id;
        check.subject = subject;
        check.group = label + ": measured render against the lens's own rays";
    }
    return checks;
}

}  // namespace lensproof::studies
