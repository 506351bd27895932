#include "calibration/self_test/self_test_json.h"

#include "engine/base/json.h"

namespace lensproof::calibration {
Json to_json(const PictureTraits& traits) {
    Json json{{"white", traits.white}, {"black", traits.black}, {"noise", traits.noise}};
    if (traits.blur_px) {
        json["blur_px"] = *traits.blur_px;
    }
    if (traits.light_gradient_per_mm) {
        json["light_gradient_per_mm"] = {traits.light_gradient_per_mm->x, traits.light_gradient_per_mm->y};
    }
    return json;
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

PictureTraits parse_traits(const JsonNode& node) {
    PictureTraits traits{.white = node.at("white").number(),
                         .black = node.at("black").number(),
                         .noise = node.at("noise").number(),
                         .blur_px = {}};
    if (node.has("blur_px")) {
        traits.blur_px = node.at("blur_px").number();
    }
    if (node.has("light_gradient_per_mm")) {
        traits.light_gradient_per_mm = node.at("light_gradient_per_mm").pair();
    }
    return traits;
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
