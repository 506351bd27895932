#include "experiments/draw/coloured_image.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace lensproof::draw {

formats::Image coloured_image(const formats::Image& values, ColourMap colours, double lowest, double highest) {
    constexpr int kShades = 256;
    constexpr Vec3d kNothing{0.3, 0.3, 0.3};
    std::vector<Vec3d> shades;
    shades.reserve(kShades);
    for (int i = 0; i < kShades; ++i) {
        shades.push_back(map_colour(colours, i / (kShades - 1.0)));
    }
    formats::Image picture = formats::make_image(values.width, values.height, {"R", "G", "B"});
    for (int y = 0; y < values.height; ++y) {
        for (int x = 0; x < values.width; ++x) {
            const auto value = static_cast<double>(values.at(x, y, 0));
            const double fraction = std::clamp((value - lowest) / (highest - lowest), 0.0, 1.0);
            const Vec3d& rgb =
                std::isnan(value) ? kNothing : shades[static_cast<std::size_t>(std::lround(fraction * (kShades - 1)))];
            picture.at(x, y, 0) = static_cast<float>(rgb.x);
            picture.at(x, y, 1) = static_cast<float>(rgb.y);
            picture.at(x, y, 2) = static_cast<float>(rgb.z);
        }
    }
    return picture;
}

}  // namespace lensproof::draw
