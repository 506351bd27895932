#include "engine/formats/image/stored_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <stdexcept>

#include "engine/base/file.h"
#include "engine/base/input_error.h"

namespace lensproof::formats {

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

std::unique_ptr<OIIO::ImageInput> open(const std::filesystem::path& file, const OIIO::ImageSpec& hints) {
    check_readable(file);
    if (!std::filesystem::is_regular_file(file)) {
        throw InputError(fmt::format("{}: is a device or a pipe, expected a picture's file", file.string()));
    }
    auto input = OIIO::ImageInput::open(file.string(), &hints);
    if (!input) {
        throw InputError(
            fmt::format("{}: not a picture that can be read: {}", file.string(), one_line(OIIO::geterror())));
    }
    const OIIO::ImageSpec& spec = input->spec();
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
    return input;
}

}  // namespace

StoredPicture read_stored(const std::filesystem::path& file, const OIIO::ImageSpec& hints) {
    const auto input = open(file, hints);
    StoredPicture stored{.image = {}, .spec = input->spec()};
    const OIIO::ImageSpec& spec = stored.spec;
    Image& image = stored.image;
    image = make_image(spec.width, spec.height, channel_names(spec));
    if (!input->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, image.pixels.data())) {
        throw InputError(fmt::format("{}: the picture is damaged: {}", file.string(), one_line(input->geterror())));
    }
    const int alpha = find_channel(image, "A");
    if (alpha >= 0 && image.channel_count() > 1) {
        drop_channel(image, alpha);
    }
    return stored;
}

OIIO::ImageSpec read_header(const std::filesystem::path& file, const OIIO::ImageSpec& hints) {
    return open(file, hints)->spec();
}

Image turned(Image image, int orientation) {
    if (orientation < 2 || orientation > 8) {
        return image;
    }
    // OpenImageIO 2.4's own reorient takes 5 for 7.
    const bool sides_swap = orientation >= 5;
    const bool from_right = orientation == 2 || orientation == 3 || orientation == 7 || orientation == 8;
    const bool from_below = orientation == 3 || orientation == 4 || orientation == 6 || orientation == 7;
    Image result =
        make_image(sides_swap ? image.height : image.width, sides_swap ? image.width : image.height, image.channels);
    for (int y = 0; y < result.height; ++y) {
        for (int x = 0; x < result.width; ++x) {
            const int along = sides_swap ? y : x;
            const int down = sides_swap ? x : y;
            const int from_x = from_right ? image.width - 1 - along : along;
            const int from_y = from_below ? image.height - 1 - down : down;
            for (int channel = 0; channel < image.channel_count(); ++channel) {
                result.at(x, y, channel) = image.at(from_x, from_y, channel);
            }
        }
    }
    return result;
}

float stated_gamma(const std::string& colour_space) {
    if (colour_space.rfind("Gamma", 0) != 0) {
        return 0.0F;
    }
    try {
        return std::stof(colour_space.substr(5));
    } catch (const std::exception&) {
        return 0.0F;
    }
}

}  // namespace lensproof::formats
