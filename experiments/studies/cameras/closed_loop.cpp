#include "experiments/studies/cameras/closed_loop.h"

#include <fmt/format.h>

#include <limits>

namespace lensproof::studies {

namespace {

/// What a limit is held against.
struct Limited {
    std::string curve;
    const char* id;
    const char* label;
    const char* unit;
    double scale;  // from the curve's unit to the check's
    bool use_rms;
};

findings::Check make_check(const Limited& limited, const calibration::Profile& measured,
                           const calibration::Profile& traced, double limit) {
    findings::Check check{.id = limited.id, .label = limited.label, .unit = limited.unit, .limit = limit};
    const calibration::CurveFloor* floor =
        measured.self_test ? calibration::floor_of(*measured.self_test, limited.curve) : nullptr;
    if (floor != nullptr) {
        check.floor = limited.scale * (limited.use_rms ? floor->rms : floor->largest);
    }
    const auto difference = calibration::difference(measured, traced, limited.curve);
    if (!difference) {
        check.value = std::numeric_limits<double>::quiet_NaN();
        check.explanation = "The curve was not measured.";
        return check;
    }
    check.value = limited.scale * (limited.use_rms ? difference->rms : difference->largest);
    check.sigma = limited.scale * (limited.use_rms ? difference->rms_sigma : difference->largest_sigma);
    check.explanation =
        limited.use_rms
            ? fmt::format(
                  "Measured minus traced, over the picture's area as far as the chart's points reach: image "
                  "heights from 0 to {:.2f} of the half-diagonal.",
                  difference->curve.covered_image_height)
            : fmt::format("Largest difference, measured minus traced; it stands at image height {:.2f} of 0 to {:.2f}.",
                          difference->largest_at, difference->curve.covered_image_height);
    return check;
}

}  // namespace

std::vector<findings::Check> closed_loop_checks(const std::string& subject, const std::string& label,
                                                const calibration::Profile& measured,
                                                const calibration::Profile& traced, const ClosedLoopLimits& limits) {
    std::vector<findings::Check> checks;
    const auto add = [&](const std::optional<double>& limit, const Limited& limited) {
        if (limit) {
            checks.push_back(make_check(limited, measured, traced, *limit));
        }
    };
    using calibration::kQuantities;
    const calibration::ChannelText& position = kQuantities.image_position.key;
    const calibration::ChannelText& shift = kQuantities.chromatic_shift.key;
    add(limits.distortion_rms_px, {position(), "distortion-rms", "image position, rms", "px", 1.0, true});
    add(limits.distortion_largest_px, {position(), "distortion-largest", "image position, largest", "px", 1.0, false});
    add(limits.vignetting_percent,
        {kQuantities.vignetting.key("G"), "vignetting", "relative illumination, largest", "%", 100.0, false});
    add(limits.chromatic_shift_px,
        {shift("R"), "chromatic-shift-R", "chromatic shift of red, largest", "px", 1.0, false});
    add(limits.chromatic_shift_px,
        {shift("B"), "chromatic-shift-B", "chromatic shift of blue, largest", "px", 1.0, false});
    for (findings::Check& check : checks) {
        check.id = subject + "-" + check.id;
        check.subject = subject;
        check.group = label + ": measured render against the lens's own rays";
    }
    return checks;
}

}  // namespace lensproof::studies
