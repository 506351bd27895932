#include "engine/formats/image/page_png.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <stdexcept>

namespace lensproof::formats {

std::string encode_page_png(int width, int height, const std::vector<unsigned char>& grey, double dpi) {
    OIIO::ImageSpec spec(width, height, 1, OIIO::TypeDesc::UINT8);
    spec.attribute("ResolutionUnit", "inch");
    spec.attribute("XResolution", static_cast<float>(dpi));
    spec.attribute("YResolution", static_cast<float>(dpi));
    std::vector<unsigned char> bytes;
    OIIO::Filesystem::IOVecOutput sink(bytes);
    const auto output = OIIO::ImageOutput::create("png", &sink);
    if (!output || !output->open("page.png", spec) || !output->write_image(spec.format, grey.data()) ||
        !output->close()) {
        throw std::runtime_error(
            fmt::format("a PNG cannot be made: {}", output ? output->geterror() : OIIO::geterror()));
    }
    return {bytes.begin(), bytes.end()};
}

}  // namespace lensproof::formats
