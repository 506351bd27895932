// tests/calibration/comparison/pictures.h — pictures by formula, that comparisons are tried on.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>

#include "engine/base/vec.h"
#include "engine/formats/image/image.h"
#include "engine/formats/image/srgb.h"

namespace lensproof::comparison_test {

/// The two pictures of tests/validation/picture_metrics_test.py, sRGB's values of 8 bits and how the second differs.
inline int wave(int x, int y, int c) {
    return (x * 5 + y * 3 + 40 * c + x * y / 7) % 256;
}
inline int change(int x, int y, int c) {
    return (x * 3 + y * 7 + c * 11) % 21 - 10;
}

template <class Light>
formats::Image made(int width, int height, const Light& light) {
    formats::Image image = formats::make_image(width, height, {"R", "G", "B"});
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            for (int c = 0; c < 3; ++c) {
                image.at(x, y, c) = static_cast<float>(light(x, y, c));
            }
        }
    }
    return image;
}

inline formats::Image low_range_picture(bool is_changed) {
    return made(96, 80, [is_changed](int x, int y, int c) {
        const int value = std::clamp(wave(x, y, c) + (is_changed ? change(x, y, c) : 0), 0, 255);
        return formats::srgb_to_linear(static_cast<float>(value) / 255.0F);
    });
}

inline formats::Image high_range_picture(bool is_changed) {
    return made(96, 80, [is_changed](int x, int y, int c) {
        const int mantissa = 128 + wave(x, y, c) / 2;
        const int value = is_changed ? std::clamp(mantissa + change(x, y, c), 128, 255) : mantissa;
        return std::ldexp(value / 256.0, (x / 6 + y / 5) % 7 - 3);
    });
}

inline constexpr auto kHere = [](const Vec2d& p) { return p; };

/// Forty soft discs of light, in closed form: the picture whose place x shows what `place`(x) of a larger scene is.
template <class Place>
formats::Image discs(int width, int height, const Place& place, double noise = 0.0, unsigned seed = 1) {
    struct Disc {
        Vec2d middle;
        double sigma;
        double light[3];
    };
    std::mt19937 scene(7);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    std::vector<Disc> all;
    for (int i = 0; i < 40; ++i) {
        const double x = (1.6 * unit(scene) - 0.3) * width;
        const double y = (1.6 * unit(scene) - 0.3) * height;
        const double sigma = 1.5 + 5.0 * unit(scene);
        all.push_back({{x, y}, sigma, {unit(scene), unit(scene), unit(scene)}});
    }
    std::mt19937 chance(seed);
    std::normal_distribution<double> normal(0.0, 1.0);
    return made(width, height, [&](int x, int y, int c) {
        const Vec2d at = place(Vec2d{static_cast<double>(x), static_cast<double>(y)});
        double light = 0.05 + (noise > 0.0 ? noise * normal(chance) : 0.0);
        for (const Disc& disc : all) {
            const double away = std::hypot(at.x - disc.middle.x, at.y - disc.middle.y) / disc.sigma;
            light += 0.5 * disc.light[c] * std::exp(-0.5 * away * away);
        }
        return light;
    });
}

}  // namespace lensproof::comparison_test
