#include "engine/io/jpeg.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

#include "engine/io/srgb.h"

namespace lensproof {

Image after_jpeg(const Image& image, int quality) {
    std::vector<unsigned char> values;
    values.reserve(image.pixels.size());
    for (const float value : image.pixels) {
        values.push_back(static_cast<unsigned char>(std::lround(255.0F * linear_to_srgb(value))));
    }
    OIIO::ImageSpec spec(image.width, image.height, image.channel_count(), OIIO::TypeDesc::UINT8);
    spec.attribute("compression", fmt::format("jpeg:{}", quality));
    std::vector<unsigned char> bytes;
    OIIO::Filesystem::IOVecOutput sink(bytes);
    const auto output = OIIO::ImageOutput::create("jpeg", &sink);
    if (!output || !output->open("picture.jpg", spec) || !output->write_image(spec.format, values.data()) ||
        !output->close()) {
        throw std::runtime_error(
            fmt::format("a JPEG cannot be made: {}", output ? output->geterror() : OIIO::geterror()));
    }
    OIIO::Filesystem::IOMemReader source(bytes.data(), bytes.size());
    const auto input = OIIO::ImageInput::open("picture.jpg", nullptr, &source);
    if (!input || !input->read_image(0, 0, 0, image.channel_count(), spec.format, values.data())) {
        throw std::runtime_error(
            fmt::format("a JPEG just made cannot be read: {}", input ? input->geterror() : OIIO::geterror()));
    }
    Image result = image;
    for (std::size_t i = 0; i < values.size(); ++i) {
        result.pixels[i] = srgb_to_linear(static_cast<float>(values[i]) / 255.0F);
    }
    return result;
}

}  // namespace lensproof
