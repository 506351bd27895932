#include "experiments/findings/shown_picture.h"

#include <algorithm>
#include <cstdlib>
#include <utility>

namespace lensproof::findings {

namespace {

/// A smaller copy: means of whole blocks of pixels.
formats::Image shrunk(const formats::Image& image, int widest) {
    const int factor = std::max(1, (image.width + widest - 1) / widest);
    formats::Image small =
        formats::make_image(std::max(1, image.width / factor), std::max(1, image.height / factor), image.channels);
    for (int y = 0; y < small.height; ++y) {
        for (int x = 0; x < small.width; ++x) {
            for (int c = 0; c < image.channel_count(); ++c) {
                float sum = 0.0F;
                for (int dy = 0; dy < factor; ++dy) {
                    for (int dx = 0; dx < factor; ++dx) {
                        sum += image.at(x * factor + dx, y * factor + dy, c);
                    }
                }
                small.at(x, y, c) = sum / static_cast<float>(factor * factor);
            }
        }
    }
    return small;
}

double attribute_of(const std::string& svg, const std::string& name) {
    const std::size_t at = svg.find(name + "=\"");
    return at == std::string::npos ? 0.0 : std::strtod(svg.c_str() + at + name.size() + 2, nullptr);
}

}  // namespace

Picture shown_picture(const std::string& name, const std::string& caption, const formats::Image& image, int widest) {
    return {.name = name,
            .caption = caption,
            .width = image.width,
            .height = image.height,
            .bytes = name.ends_with(".jpg") ? formats::encode_jpeg(shrunk(image, widest))
                                            : formats::encode_png(shrunk(image, widest))};
}

Picture drawn_picture(const std::string& name, const std::string& caption, std::string svg) {
    Picture picture{.name = name,
                    .caption = caption,
                    .width = attribute_of(svg, "width"),
                    .height = attribute_of(svg, "height"),
                    .bytes = {}};
    picture.bytes = std::move(svg);
    return picture;
}

std::string laid_picture(const formats::Image& image) {
    return formats::encode_jpeg(shrunk(image, kLaidWidth));
}

}  // namespace lensproof::findings
