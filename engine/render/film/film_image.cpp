#include "engine/render/film/film_image.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/spectral/spectral_exr.h"

namespace lensproof::render {

namespace {

void put_rgb(const Vec3d& rgb, float* to) {
    to[0] = static_cast<float>(rgb.x);
    to[1] = static_cast<float>(rgb.y);
    to[2] = static_cast<float>(rgb.z);
}

}  // namespace

formats::Image film_image(const Picture& film) {
    std::vector<std::string> channels = {"R", "G", "B", "error.R", "error.G", "error.B"};
    for (const double nm : film.layout().layer_nm) {
        channels.push_back(spectral::spectral_channel_name(nm));
    }
    formats::Image image = formats::make_image(film.width(), film.height(), std::move(channels));
    std::vector<double> layers(film.layout().layer_nm.size());
    for (int y = 0; y < film.height(); ++y) {
        for (int x = 0; x < film.width(); ++x) {
            const auto [rgb, variance] = film.estimate(x, y);
            float* pixel = &image.at(x, y, 0);
            put_rgb(rgb, pixel);
            put_rgb({std::sqrt(variance.x), std::sqrt(variance.y), std::sqrt(variance.z)}, pixel + 3);
            film.layers(x, y, layers);
            std::ranges::transform(layers, pixel + 6, [](double value) { return static_cast<float>(value); });
        }
    }
    return image;
}

formats::Image film_rgb(const Picture& film) {
    formats::Image image = formats::make_image(film.width(), film.height(), {"R", "G", "B"});
    for (int y = 0; y < film.height(); ++y) {
        for (int x = 0; x < film.width(); ++x) {
            put_rgb(film.estimate(x, y).rgb, &image.at(x, y, 0));
        }
    }
    return image;
}

}  // namespace lensproof::render
