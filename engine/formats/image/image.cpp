#include "engine/formats/image/image.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "engine/base/input_error.h"
#include "engine/base/write_file.h"
#include "engine/formats/image/exr_output.h"
#include "engine/formats/image/exr_parts.h"
#include "engine/formats/image/frame_placement.h"
#include "engine/formats/image/srgb.h"
#include "engine/formats/image/stored_picture.h"

namespace lensproof::formats {

namespace {

void linearise(Image& image, const std::string& colour_space) {
    // PNG's gAMA of 1/2.2 stands for sRGB in practice.
    const float gamma = stated_gamma(colour_space);
    const bool linear = colour_space == "linear" || colour_space == "Linear";
    for (float& value : image.pixels) {
        if (gamma > 0.0F && std::abs(gamma - 2.2F) > 0.05F) {
            value = std::pow(std::max(value, 0.0F), gamma);
        } else if (!linear) {
            value = srgb_to_linear(value);
        }
    }
}

/// Channel by channel, which of the image's go into a PNG.
std::vector<int> shown_channels(const Image& image) {
    std::vector<int> sources;
    for (const char* name : {"R", "G", "B"}) {
        sources.push_back(find_channel(image, name));
    }
    if (std::find(sources.begin(), sources.end(), -1) != sources.end()) {
        sources = {std::max(0, find_channel(image, "Y"))};
    }
    return sources;
}

template <class Integer>
std::vector<Integer> encode_srgb(const Image& image, const std::vector<int>& sources) {
    std::vector<Integer> encoded;
    encoded.reserve(static_cast<std::size_t>(image.width) * image.height * sources.size());
    constexpr auto kFullScale = static_cast<float>(std::numeric_limits<Integer>::max());
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            for (const int source : sources) {
                const float value = image.at(x, y, source);
                if constexpr (sizeof(Integer) == 1) {
                    encoded.push_back(linear_to_srgb_byte(value));
                } else {
                    encoded.push_back(static_cast<Integer>(std::lround(kFullScale * linear_to_srgb(value))));
                }
            }
        }
    }
    return encoded;
}

/// The bytes of a file of that form, "png" or "jpeg", whose pixels are of the type that `spec` says.
std::string file_bytes(const std::string& form, const OIIO::ImageSpec& spec, const void* pixels) {
    std::vector<unsigned char> bytes;
    OIIO::Filesystem::IOVecOutput sink(bytes);
    const auto output = OIIO::ImageOutput::create(form, &sink);
    if (!output || !output->open("picture." + form, spec) || !output->write_image(spec.format, pixels) ||
        !output->close()) {
        throw std::runtime_error(
            fmt::format("a {} cannot be made: {}", form, output ? output->geterror() : OIIO::geterror()));
    }
    return {bytes.begin(), bytes.end()};
}

template <class Integer>
std::string encode_srgb_file(const std::string& form, const Image& image, OIIO::TypeDesc type, int quality = 0) {
    const std::vector<int> sources = shown_channels(image);
    OIIO::ImageSpec spec(image.width, image.height, static_cast<int>(sources.size()), type);
    spec.attribute("oiio:ColorSpace", "sRGB");
    if (quality > 0) {
        spec.attribute("compression", fmt::format("jpeg:{}", quality));
        spec.attribute("jpeg:subsampling", "4:4:4");
    }
    return file_bytes(form, spec, encode_srgb<Integer>(image, sources).data());
}

OIIO::ImageSpec exr_spec(const Image& image) {
    OIIO::ImageSpec spec(image.width, image.height, image.channel_count(), OIIO::TypeDesc::FLOAT);
    spec.channelnames = image.channels;
    spec.attribute("compression", "zip");
    spec.attribute("oiio:ColorSpace", "linear");
    spec.attribute("DateTime",
                   "1970:01:01 00:00:00");  // else the library writes the clock's: the same render, other bytes
    for (const auto& [name, value] : image.metadata) {
        spec.attribute(name, value);
    }
    return spec;
}

}  // namespace

Image make_image(int width, int height, std::vector<std::string> channels) {
    Image image{.width = width, .height = height, .channels = std::move(channels), .pixels = {}, .metadata = {}};
    image.pixels.assign(static_cast<std::size_t>(width) * height * image.channels.size(), 0.0F);
    return image;
}

int find_channel(const Image& image, const std::string& name) {
    const auto found = std::find(image.channels.begin(), image.channels.end(), name);
    return found == image.channels.end() ? -1 : static_cast<int>(found - image.channels.begin());
}

Image read_image(const std::filesystem::path& file) {
    StoredPicture stored = read_stored(file, {});
    Image image = turned(std::move(stored.image), stored.spec.get_int_attribute("Orientation", 1));
    if (!stored.spec.format.is_floating_point()) {
        linearise(image, stored.spec.get_string_attribute("oiio:ColorSpace", "sRGB"));
    }
    for (const auto& attribute : stored.spec.extra_attribs) {
        image.metadata[attribute.name().string()] = attribute.get_string();
    }
    return image;
}

void write_exr(const Image& image, const std::filesystem::path& file) {
    write_exr(image, file, {.x = 0, .y = 0, .frame_width = image.width, .frame_height = image.height});
}

void write_exr(const Image& image, const std::filesystem::path& file, const FramePlacement& placement) {
    OIIO::ImageSpec spec = exr_spec(image);
    spec.x = placement.x;
    spec.y = placement.y;
    spec.full_width = placement.frame_width;
    spec.full_height = placement.frame_height;
    write_exr_file(file, [&](OIIO::ImageOutput& output, const std::string& name) {
        return output.open(name, spec) && output.write_image(OIIO::TypeDesc::FLOAT, image.pixels.data()) &&
               output.close();
    });
}

void write_exr(const std::vector<NamedImage>& parts, const std::filesystem::path& file) {
    std::vector<OIIO::ImageSpec> specs;
    for (const NamedImage& part : parts) {
        specs.push_back(exr_spec(part.image));
        specs.back().attribute("oiio:subimagename", part.name);
    }
    write_exr_file(file, [&](OIIO::ImageOutput& output, const std::string& name) {
        bool is_written = output.open(name, static_cast<int>(specs.size()), specs.data());
        for (std::size_t i = 0; is_written && i < parts.size(); ++i) {
            is_written = (i == 0 || output.open(name, specs[i], OIIO::ImageOutput::AppendSubimage)) &&
                         output.write_image(OIIO::TypeDesc::FLOAT, parts[i].image.pixels.data());
        }
        return is_written && output.close();
    });
}

void write_png(const Image& image, const std::filesystem::path& file) {
    write_file(file, encode_png(image));
}

void write_png_16(const Image& image, const std::filesystem::path& file) {
    write_file(file, encode_srgb_file<std::uint16_t>("png", image, OIIO::TypeDesc::UINT16));
}

void write_png(const IntegerImage& image, const std::filesystem::path& file) {
    OIIO::ImageSpec spec(image.width, image.height, image.channels, OIIO::TypeDesc::UINT16);
    spec.attribute("oiio:ColorSpace", "linear");
    for (const auto& [name, value] : image.metadata) {
        spec.attribute(name, value);
    }
    write_file(file, file_bytes("png", spec, image.values.data()));
}

std::string encode_png(const Image& image) {
    return encode_srgb_file<unsigned char>("png", image, OIIO::TypeDesc::UINT8);
}

std::string encode_jpeg(const Image& image, int quality) {
    return encode_srgb_file<unsigned char>("jpeg", image, OIIO::TypeDesc::UINT8, quality);
}

}  // namespace lensproof::formats
