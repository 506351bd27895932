#include "calibration/picture/picture_account.h"

#include <array>
#include <utility>

#include "engine/base/json.h"

namespace lensproof::calibration {
namespace {
// The keys of the notes that are numbers, and where they belong.
constexpr std::array kNumbers = {
    std::pair{"focal_length_mm", &formats::CameraNotes::focal_length_mm},
    std::pair{"equivalent_focal_length_mm", &formats::CameraNotes::equivalent_focal_length_mm},
    std::pair{"f_number", &formats::CameraNotes::f_number},
    std::pair{"exposure_time_s", &formats::CameraNotes::exposure_time_s},
    std::pair{"iso", &formats::CameraNotes::iso},
    std::pair{"pixel_pitch_um", &formats::CameraNotes::pixel_pitch_um},
};
constexpr std::array kTexts = {
    std::pair{"make", &formats::CameraNotes::make},         std::pair{"model", &formats::CameraNotes::model},
    std::pair{"lens", &formats::CameraNotes::lens},         std::pair{"software", &formats::CameraNotes::software},
    std::pair{"transfer", &formats::CameraNotes::transfer},
};

}  // namespace

Json to_json(const formats::CameraNotes& notes) {
    Json json = Json::object();
    for (const auto& [key, member] : kTexts) {
        if (!(notes.*member).empty()) {
            json[key] = notes.*member;
        }
    }
    for (const auto& [key, member] : kNumbers) {
        if (notes.*member) {
            json[key] = *(notes.*member);
        }
    }
    if (const auto crop = notes.crop_factor()) {
        json["crop_factor"] = *crop;
    }
    return json;
}

formats::CameraNotes parse_camera_notes(const JsonNode& node) {
    formats::CameraNotes notes;
    for (const auto& [key, member] : kTexts) {
        if (node.has(key)) {
            notes.*member = node.at(key).text();
        }
    }
    for (const auto& [key, member] : kNumbers) {
        if (node.has(key)) {
            const double value = node.at(key).number();
            if (!(value > 0.0)) {
                throw node.at(key).error("a number above 0");
            }
            notes.*member = value;
        }
    }
    return notes;
}

Json to_json(const PictureAccount& account) {
    Json json = {{"image", account.image}, {"role", account.role}, {"used", account.used}};
    if (!account.reason.empty()) {
        json["reason"] = account.reason;
    }
    if (account.orientation != 1) {
        json["exif_orientation"] = account.orientation;
    }
    return json;
}

PictureAccount parse_picture_account(const JsonNode& node) {
    return {.image = node.at("image").text(),
            .role = node.at("role").text(),
            .used = node.at("used").truth(),
            .reason = node.has("reason") ? node.at("reason").text() : "",
            .orientation = node.has("exif_orientation") ? node.at("exif_orientation").count() : 1};
}

}  // namespace lensproof::calibration
