#include "engine/formats/image/stored_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "engine/base/input_error.h"

namespace lensproof::formats {

namespace {

constexpr double kMostValues = 2e9;  // in all channels

std::vector<std::string> channel_names(const OIIO::ImageSpec& spec) {
    std::vector<std::string> names = spec.channelnames;
    if (names.size() == 1) {
        names[0] = "Y";
    }
    return names;
}

/// In place: pixels take half of the memory there is at most, and not twice.
void drop_channel(Image& image, std::size_t dropped) {
    const std::size_t channels = image.channels.size();
    std::size_t kept = 0;
    for (std::size_t i = 0; i < image.pixels.size(); ++i) {
        if (i % channels != dropped) {
            image.pixels[kept++] = image.pixels[i];
        }
    }
    image.pixels.resize(kept);
    image.channels.erase(image.channels.begin() + static_cast<std::ptrdiff_t>(dropped));
}

OpenPicture open(const std::filesystem::path& file, const OIIO::ImageSpec& hints) {
    OpenPicture picture = open_picture(file, hints);
    const OIIO::ImageSpec& spec = picture.input->spec();
    if (static_cast<double>(spec.width) * spec.height * spec.nchannels > kMostValues) {
        throw InputError(fmt::format("{}: {} × {} pixels with {} channels, expected at most {:.0f} million values",
                                     file.string(), spec.width, spec.height, spec.nchannels, kMostValues / 1e6));
    }
    check_picture_size(file, spec, spec.nchannels, sizeof(float) * static_cast<double>(spec.nchannels));
    return picture;
}

}  // namespace

StoredPicture read_stored(const std::filesystem::path& file, const OIIO::ImageSpec& hints) {
    const auto [form, input] = open(file, hints);
    StoredPicture stored{.image = {}, .spec = input->spec(), .form = form};
    const OIIO::ImageSpec& spec = stored.spec;
    Image& image = stored.image;
    image = make_image(spec.width, spec.height, channel_names(spec));
    input->geterror();  // of the header's lesser parts
    const bool is_read = input->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, image.pixels.data());
    // The reader of TIFF leaves strips that are missing black, takes note, and succeeds.
    if (!is_read || input->has_error()) {
        throw InputError(fmt::format("{}: the picture is damaged: {}", file.string(), on_one_line(input->geterror())));
    }
    const int alpha = find_channel(image, "A");
    if (alpha >= 0 && image.channel_count() > 1) {
        drop_channel(image, static_cast<std::size_t>(alpha));
    }
    return stored;
}

StoredHeader read_header(const std::filesystem::path& file, const OIIO::ImageSpec& hints) {
    const auto [form, input] = open(file, hints);
    return {.spec = input->spec(), .form = form};
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
