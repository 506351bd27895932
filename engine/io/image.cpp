#include "engine/io/image.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "engine/io/file.h"
#include "engine/io/input_error.h"
#include "engine/io/srgb.h"

namespace lensproof {

namespace {

constexpr double kMostPixels = 200e6;
constexpr double kMostValues = 2e9;  // in all channels

/// The library's message without its line breaks.
std::string one_line(std::string message) {
    while (!message.empty() && message.back() == '\n') {
        message.pop_back();
    }
    std::ranges::replace(message, '\n', ';');
    return message;
}

void linearise(Image& image, const std::string& colour_space) {
    // OpenImageIO writes a stated gamma as "GammaX.Y" (older) or "gamma"; PNG's gAMA of 1/2.2 stands for sRGB in
    // practice.
    float gamma = 0.0F;
    if (colour_space.rfind("Gamma", 0) == 0) {
        try {
            gamma = std::stof(colour_space.substr(5));
        } catch (const std::exception&) {
            gamma = 0.0F;
        }
    }
    const bool linear = colour_space == "linear" || colour_space == "Linear";
    for (float& value : image.pixels) {
        if (gamma > 0.0F && std::abs(gamma - 2.2F) > 0.05F) {
            value = std::pow(std::max(value, 0.0F), gamma);
        } else if (!linear) {
            value = srgb_to_linear(value);
        }
    }
}

std::vector<std::string> channel_names(const OIIO::ImageSpec& spec) {
    std::vector<std::string> names = spec.channelnames;
    if (names.size() == 1) {
        names[0] = "Y";
    }
    return names;
}

void drop_channel(Image& image, int dropped) {
    Image kept = make_image(image.width, image.height, [&] {
        std::vector<std::string> names = image.channels;
        names.erase(names.begin() + dropped);
        return names;
    }());
    kept.metadata = image.metadata;
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            for (int from = 0, to = 0; from < image.channel_count(); ++from) {
                if (from != dropped) {
                    kept.at(x, y, to++) = image.at(x, y, from);
                }
            }
        }
    }
    image = std::move(kept);
}

void write_with_oiio(const OIIO::ImageSpec& spec, OIIO::TypeDesc type, const void* pixels,
                     const std::filesystem::path& file) {
    write_whole(file, [&](const std::filesystem::path& temporary) {
        const auto output = OIIO::ImageOutput::create(temporary.string());
        if (!output || !output->open(temporary.string(), spec) || !output->write_image(type, pixels) ||
            !output->close()) {
            throw std::runtime_error(fmt::format("{}: cannot be written: {}", file.string(),
                                                 output ? output->geterror() : OIIO::geterror()));
        }
    });
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
                encoded.push_back(
                    static_cast<Integer>(std::lround(kFullScale * linear_to_srgb(image.at(x, y, source)))));
            }
        }
    }
    return encoded;
}

/// The bytes of a PNG whose pixels are of the type that `spec` says.
std::string png_bytes(const OIIO::ImageSpec& spec, const void* pixels) {
    std::vector<unsigned char> bytes;
    OIIO::Filesystem::IOVecOutput sink(bytes);
    const auto output = OIIO::ImageOutput::create("png", &sink);
    if (!output || !output->open("picture.png", spec) || !output->write_image(spec.format, pixels) ||
        !output->close()) {
        throw std::runtime_error(
            fmt::format("a PNG cannot be made: {}", output ? output->geterror() : OIIO::geterror()));
    }
    return {bytes.begin(), bytes.end()};
}

template <class Integer>
std::string encode_srgb_png(const Image& image, OIIO::TypeDesc type) {
    const std::vector<int> sources = shown_channels(image);
    OIIO::ImageSpec spec(image.width, image.height, static_cast<int>(sources.size()), type);
    spec.attribute("oiio:ColorSpace", "sRGB");
    return png_bytes(spec, encode_srgb<Integer>(image, sources).data());
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
    check_readable(file);
    if (!std::filesystem::is_regular_file(file)) {
        throw InputError(fmt::format("{}: is a device or a pipe, expected a picture's file", file.string()));
    }
    auto input = OIIO::ImageInput::open(file.string());
    if (!input) {
        throw InputError(
            fmt::format("{}: not a picture that can be read: {}", file.string(), one_line(OIIO::geterror())));
    }
    const OIIO::ImageSpec spec = input->spec();
    if (spec.width < 1 || spec.height < 1 || spec.depth > 1 || spec.nchannels < 1) {
        throw InputError(fmt::format("{}: a picture of {} × {} pixels with {} channels, expected a flat picture",
                                     file.string(), spec.width, spec.height, spec.nchannels));
    }
    if (static_cast<double>(spec.width) * spec.height > kMostPixels) {
        throw InputError(fmt::format("{}: {} × {} pixels, expected at most {:.0f} million", file.string(), spec.width,
                                     spec.height, kMostPixels / 1e6));
    }
    if (static_cast<double>(spec.width) * spec.height * spec.nchannels > kMostValues) {
        throw InputError(fmt::format("{}: {} × {} pixels with {} channels, expected at most {:.0f} million values",
                                     file.string(), spec.width, spec.height, spec.nchannels, kMostValues / 1e6));
    }
    Image image = make_image(spec.width, spec.height, channel_names(spec));
    if (!input->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, image.pixels.data())) {
        throw InputError(fmt::format("{}: the picture is damaged: {}", file.string(), one_line(input->geterror())));
    }
    input->close();

    const int orientation = spec.get_int_attribute("Orientation", 1);
    if (orientation != 1) {
        OIIO::ImageBuf stored(spec, image.pixels.data());
        const OIIO::ImageBuf upright = OIIO::ImageBufAlgo::reorient(stored);
        Image turned = make_image(upright.spec().width, upright.spec().height, image.channels);
        upright.get_pixels(OIIO::ROI::All(), OIIO::TypeDesc::FLOAT, turned.pixels.data());
        image = std::move(turned);
    }
    const int alpha = find_channel(image, "A");
    if (alpha >= 0 && image.channel_count() > 1) {
        drop_channel(image, alpha);
    }
    if (!spec.format.is_floating_point()) {
        linearise(image, spec.get_string_attribute("oiio:ColorSpace", "sRGB"));
    }
    for (const auto& attribute : spec.extra_attribs) {
        image.metadata[attribute.name().string()] = attribute.get_string();
    }
    return image;
}

void write_exr(const Image& image, const std::filesystem::path& file) {
    OIIO::ImageSpec spec(image.width, image.height, image.channel_count(), OIIO::TypeDesc::FLOAT);
    spec.channelnames = image.channels;
    spec.attribute("compression", "zip");
    spec.attribute("oiio:ColorSpace", "linear");
    spec.attribute("DateTime",
                   "1970:01:01 00:00:00");  // else the library writes the clock's: the same render, other bytes
    for (const auto& [name, value] : image.metadata) {
        spec.attribute(name, value);
    }
    write_with_oiio(spec, OIIO::TypeDesc::FLOAT, image.pixels.data(), file);
}

void write_png(const Image& image, const std::filesystem::path& file) {
    write_file(file, encode_png(image));
}

void write_png_16(const Image& image, const std::filesystem::path& file) {
    write_file(file, encode_srgb_png<std::uint16_t>(image, OIIO::TypeDesc::UINT16));
}

void write_png(const IntegerImage& image, const std::filesystem::path& file) {
    OIIO::ImageSpec spec(image.width, image.height, image.channels, OIIO::TypeDesc::UINT16);
    spec.attribute("oiio:ColorSpace", "linear");
    for (const auto& [name, value] : image.metadata) {
        spec.attribute(name, value);
    }
    write_file(file, png_bytes(spec, image.values.data()));
}

std::string encode_png(const Image& image) {
    return encode_srgb_png<unsigned char>(image, OIIO::TypeDesc::UINT8);
}

}  // namespace lensproof
