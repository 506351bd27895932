#include "calibration/profile/self_test_result.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "calibration/profile/quantity.h"

namespace lensproof::calibration {

const CurveFloor* floor_of(const SelfTest& test, const std::string& curve) {
    const auto found = test.curves.find(curve);
    return found == test.curves.end() ? nullptr : &found->second;
}

std::string describe_floor(const SelfTest& test) {
    std::string text = fmt::format("points {:.3f} px", test.point_rms_px);
    if (const CurveFloor* radial = floor_of(test, kQuantities.image_position.key())) {
        text += fmt::format(", image position {:.3f} px rms", radial->rms);
    }
    const auto largest = [&](const Quantity& quantity) {
        std::optional<double> most;
        for (const auto& [name, floor] : test.curves) {
            if (quantity.key.channel_in(name)) {
                most = std::max(most.value_or(0.0), floor.largest);
            }
        }
        return most;
    };
    if (const auto ev = largest(kQuantities.vignetting_ev)) {
        text += fmt::format(", vignetting {:.2f} %", 100.0 * (std::exp2(*ev) - 1.0));
    }
    if (const auto shift = largest(kQuantities.chromatic_shift)) {
        text += fmt::format(", chromatic shift {:.3f} px", *shift);
    }
    return text;
}

void fields(JsonArchive& json, CurveFloor& floor) {
    json.field("rms", floor.rms).field("largest", floor.largest).field("largest_at_image_height", floor.largest_at);
}

void fields(JsonArchive& json, SelfTest& test) {
    json.field("pictures", test.pictures)
        .field("points", test.points)
        .field("point_rms_px", test.point_rms_px)
        .field("point_bias_px", test.point_bias_px)
        .field("curves", test.curves)
        .optional("reprojection_rms_px", test.reprojection_rms_px)
        .optional("focal_length_px", test.focal_length_px);
}

}  // namespace lensproof::calibration
