#include "experiments/studies/cameras/closed_loop.h"

#include <fmt/format.h>

#include <limits>

namespace lensproof::studies {

namespace {

struct Quantity {
    const char* curve;
    const char* id;
    const char* label;
    const char* unit;
    double scale;  // from the curve's unit to the check's
    bool use_rms;
};

findings::Check make_check(const Quantity& quantity, const calibration::Profile& measured,
                           const calibration::Profile& traced, double limit) {
    findings::Check check{.id = quantity.id, .label = quantity.label, .unit = quantity.unit, .limit = limit};
    if (const calibration::CurveFloor* floor = calibration::floor_of(measured.self_test, quantity.curve)) {
        check.floor = quantity.scale * (quantity.use_rms ? floor->rms : floor->largest);
    }
    const auto difference = difference_in(quantity.curve, measured, traced);
    if (!difference) {
        check.value = std::numeric_limits<double>::quiet_NaN();
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

std::optional<calibration::CurveDifference> difference_in(const std::string& curve, const calibration::Profile& a,
                                                          const calibration::Profile& b) {
    return curve == "radial_px" ? calibration::radial_difference_px(a, b) : calibration::difference(a, b, curve);
}

std::vector<findings::Check> closed_loop_checks(const std::string& subject, const std::string& label,
                                                const calibration::Profile& measured,
                                                const calibration::Profile& traced, const ClosedLoopLimits& limits) {
    std::vector<findings::Check> checks;
    const auto add = [&](const std::optional<double>& limit, const Quantity& quantity) {
        if (limit) {
            checks.push_back(make_check(quantity, measured, traced, *limit));
        }
    };
    add(limits.distortion_rms_px, {"radial_px", "distortion-rms", "image position, rms", "px", 1.0, true});
    add(limits.distortion_largest_px, {"radial_px", "distortion-largest", "image position, largest", "px", 1.0, false});
    add(limits.vignetting_percent, {"vignetting_G", "vignetting", "relative illumination, largest", "%", 100.0, false});
    add(limits.chromatic_shift_px,
        {"chromatic_shift_R_px", "chromatic-shift-R", "chromatic shift of red, largest", "px", 1.0, false});
    add(limits.chromatic_shift_px,
        {"chromatic_shift_B_px", "chromatic-shift-B", "chromatic shift of blue, largest", "px", 1.0, false});
    for (findings::Check& check : checks) {
        check.id = subject + "-" + check.id;
        check.subject = subject;
        check.group = label + ": measured render against the lens's own rays";
    }
    return checks;
}

}  // namespace lensproof::studies
