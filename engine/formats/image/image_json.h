// engine/formats/image/image_json.h — a picture as JSON, bit for bit: for what is kept between runs.
#pragma once
#include "engine/base/json_archive.h"
#include "engine/formats/image/image.h"

namespace lensproof::formats {

void fields(JsonArchive& json, Image& image);

}  // namespace lensproof::formats
