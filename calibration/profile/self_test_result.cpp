#include "calibration/profile/self_test_result.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "engine/base/json.h"

namespace lensproof::calibration {

const CurveFloor* floor_of(const std::optional<SelfTest>& test, const std::string& curve) {
    if (!test) {
        return nullptr;
    }
    const auto found = test->curves.find(curve);
    return found == test->curves.end() ? nullptr : &found->second;
}

std::string describe_floor(const SelfTest& test) {
    std::string text = fmt::format("points {:.3f} px", test.point_rms_px);
    if (const auto radial = test.curves.find("radial_px"); radial != test.curves.end()) {
        text += fmt::format(", image position {:.3f} px rms", radial->second.rms);
    }
    const auto largest = [&](std::string_view prefix, std::string_view suffix) {
        std::optional<double> most;
        for (const auto& [name, floor] : test.curves) {
            if (name.starts_with(prefix) && name.ends_with(suffix)) {
                most = std::max(most.value_or(0.0), floor.largest);
            }
        }
        return most;
    };
    if (const auto ev = largest("vignetting_", "_ev")) {
        text += fmt::format(", vignetting {:.2f} %", 100.0 * (std::exp2(*ev) - 1.0));
    }
    if (const auto shift = largest("chromatic_shift_", "_px")) {
        text += fmt::format(", chromatic shift {:.3f} px", *shift);
    }
    return text;
}

Json to_json(const SelfTest& test) {
    Json json{{"pictures", test.pictures},
              {"points", test.points},
              {"point_rms_px", test.point_rms_px},
              {"point_bias_px", test.point_bias_px},
              {"curves", Json::object()}};
    if (test.reprojection_rms_px) {
        json["reprojection_rms_px"] = *test.reprojection_rms_px;
    }
    if (test.focal_length_px) {
        json["focal_length_px"] = *test.focal_length_px;
    }
    for (const auto& [name, floor] : test.curves) {
        json["curves"][name] = {
            {"rms", floor.rms}, {"largest", floor.largest}, {"largest_at_image_height", floor.largest_at}};
    }
    return json;
}

SelfTest parse_self_test(const JsonNode& node) {
    SelfTest test{.point_rms_px = node.at("point_rms_px").number(),
                  .point_bias_px = node.at("point_bias_px").number(),
                  .points = node.at("points").count(),
                  .pictures = node.at("pictures").count(),
                  .curves = {}};
    for (const auto& [name, value] : {std::pair("reprojection_rms_px", &test.reprojection_rms_px),
                                      std::pair("focal_length_px", &test.focal_length_px)}) {
        if (node.has(name)) {
            *value = node.at(name).number();
        }
    }
    const JsonNode curves = node.at("curves");
    for (const std::string& name : curves.keys()) {
        const JsonNode floor = curves.at(name);
        test.curves[name] = {.rms = floor.at("rms").number(),
                             .largest = floor.at("largest").number(),
                             .largest_at = floor.at("largest_at_image_height").number()};
    }
    return test;
}

}  // namespace lensproof::calibration
