#include "calibration/comparison/colour_planes.h"

#include <array>

#include "calibration/comparison/stripes.h"
#include "engine/formats/image/srgb.h"
#include "engine/spectral/colour_matching.h"

namespace lensproof::calibration {

namespace {

// D65 as IEC 61966-2-1 states it: x = 0.3127, y = 0.3290.
const std::array<Vec3d, 3> kPrimaries =
    spectral::rec709_primaries({0.3127 / 0.3290, 1.0, (1.0 - 0.3127 - 0.3290) / 0.3290});
// Rows of the inverse.
const double kVolume = dot(kPrimaries[0], cross(kPrimaries[1], kPrimaries[2]));
const std::array<Vec3d, 3> kInverse{1.0 / kVolume * cross(kPrimaries[1], kPrimaries[2]),
                                    1.0 / kVolume* cross(kPrimaries[2], kPrimaries[0]),
                                    1.0 / kVolume* cross(kPrimaries[0], kPrimaries[1])};

}  // namespace

const Vec3d kWhite = kPrimaries[0] + kPrimaries[1] + kPrimaries[2];

bool is_shown(const formats::Image& image) {
    return image.channels == std::vector<std::string>{"R", "G", "B"} || image.channels.size() == 1;
}

Vec3d xyz_of(const Vec3d& linear_rgb) {
    return linear_rgb.x * kPrimaries[0] + linear_rgb.y * kPrimaries[1] + linear_rgb.z * kPrimaries[2];
}

Vec3d rgb_of(const Vec3d& xyz) {
    return {dot(kInverse[0], xyz), dot(kInverse[1], xyz), dot(kInverse[2], xyz)};
}

formats::Image luminance_of(const formats::Image& image) {
    formats::Image result = formats::make_image(image.width, image.height, {"Y"});
    for (std::size_t i = 0; i < result.pixels.size(); ++i) {
        result.pixels[i] = static_cast<float>(luminance(rgb_at(image, i)));
    }
    return result;
}

formats::Image displayed(const formats::Image& image, int threads) {
    formats::Image result = formats::make_image(image.width, image.height, image.channels);
    const std::size_t row = static_cast<std::size_t>(image.width) * image.channels.size();
    for_stripes(image.height, 0, threads, [&](const Stripe& stripe) {
        for (std::size_t i = row * static_cast<std::size_t>(stripe.first);
             i < row * static_cast<std::size_t>(stripe.last); ++i) {
            result.pixels[i] = formats::linear_to_srgb(image.pixels[i]);
        }
    });
    return result;
}

}  // namespace lensproof::calibration
