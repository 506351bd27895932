#include "engine/formats/image/image_json.h"

namespace lensproof::formats {

void fields(JsonArchive& json, Image& image) {
    json.field("width", image.width)
        .field("height", image.height)
        .field("channels", image.channels)
        .packed("pixels", image.pixels)
        .field("metadata", image.metadata)
        .expect("pixels",
                image.pixels.size() == static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height) *
                                           image.channels.size(),
                "as many numbers as pixels have channels");
}

}  // namespace lensproof::formats
