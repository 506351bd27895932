// calibration/picture/picture_account.h — what became of each picture of a set, and what its camera noted.
#pragma once
#include <string>
#include <vector>

#include "engine/base/json_archive.h"
#include "engine/formats/image/photo.h"

namespace lensproof::calibration {

/// Used or left out, and why.
struct PictureAccount {
    std::string image;
    std::string role;  // "chart" or "flat field"
    bool used = false;
    std::string reason;   // why it was left out, in words; or what is to be known of one that was used
    int orientation = 1;  // EXIF's, not applied: pixels are the sensor's

    friend bool operator==(const PictureAccount&, const PictureAccount&) = default;
};

void fields(JsonArchive& json, formats::CameraNotes& notes);
void fields(JsonArchive& json, PictureAccount& account);

}  // namespace lensproof::calibration
