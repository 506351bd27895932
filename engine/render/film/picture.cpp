#include "engine/render/film/picture.h"

#include <algorithm>
#include <functional>

namespace lensproof::render {

Picture::Picture(const std::vector<PassFilm>& films) {
    std::ranges::transform(films, std::back_inserter(parts_), [](const PassFilm& of) {
        return Part{of.pass, &of.film};
    });
}

std::uint64_t Picture::left_out() const {
    std::uint64_t sum = 0;
    for (const Part& part : parts_) {
        sum += part.film->left_out();
    }
    return sum;
}

PixelEstimate Picture::estimate(int x, int y) const {
    PixelEstimate sum = parts_.front().film->estimate(x, y);
    for (std::size_t i = 1; i < parts_.size(); ++i) {
        const auto [rgb, variance] = parts_[i].film->estimate(x, y);
        sum = {sum.rgb + rgb, sum.variance + variance};
    }
    return sum;
}

void Picture::layers(int x, int y, std::span<double> irradiance) const {
    parts_.front().film->layers(x, y, irradiance);
    std::vector<double> more(irradiance.size());
    for (std::size_t i = 1; i < parts_.size(); ++i) {
        parts_[i].film->layers(x, y, more);
        std::ranges::transform(irradiance, more, irradiance.begin(), std::plus<>());
    }
}

}  // namespace lensproof::render
