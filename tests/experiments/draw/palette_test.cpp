#include "experiments/draw/palette.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <string>

namespace lensproof::draw::palette_test {

using Triple = std::array<double, 3>;
using Matrix = std::array<Triple, 3>;

Triple product(const Matrix& m, const Triple& v) {
    Triple result{};
    for (std::size_t i = 0; i < 3; ++i) {
        result[i] = m[i][0] * v[0] + m[i][1] * v[1] + m[i][2] * v[2];
    }
    return result;
}

/// Of "#rrggbb", after IEC 61966-2-1.
Triple linear_rgb(const std::string& colour) {
    Triple rgb{};
    for (std::size_t i = 0; i < 3; ++i) {
        const double value = std::stoi(colour.substr(1 + 2 * i, 2), nullptr, 16) / 255.0;
        rgb[i] = value <= 0.04045 ? value / 12.92 : std::pow((value + 0.055) / 1.055, 2.4);
    }
    return rgb;
}

constexpr Matrix kToXyz = {{{0.4124564, 0.3575761, 0.1804375},  // IEC 61966-2-1
                            {0.2126729, 0.7151522, 0.0721750},
                            {0.0193339, 0.1191920, 0.9503041}}};

/// CIELAB under the screen's white.
Triple lab(const Triple& linear) {
    const Triple white = product(kToXyz, {1.0, 1.0, 1.0});
    const Triple xyz = product(kToXyz, linear);
    Triple f{};
    for (std::size_t i = 0; i < 3; ++i) {
        const double t = std::max(0.0, xyz[i] / white[i]);
        f[i] = t > 216.0 / 24389.0 ? std::cbrt(t) : (24389.0 / 27.0 * t + 16.0) / 116.0;
    }
    return {116.0 * f[1] - 16.0, 500.0 * (f[0] - f[1]), 200.0 * (f[1] - f[2])};
}

double distance(const Triple& a, const Triple& b) {
    return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

/// What trichromats, protanopes, deuteranopes and tritanopes see, in linear RGB: Machado, Oliveira & Fernandes, A
/// physiologically-based model for simulation of color vision deficiency (2009), severity 1.
constexpr std::array<Matrix, 4> kEyes = {
    {{{{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}}},
     {{{0.152286, 1.052583, -0.204868}, {0.114503, 0.786281, 0.099216}, {-0.003882, -0.048116, 1.051998}}},
     {{{0.367322, 0.860646, -0.227968}, {0.280085, 0.672501, 0.047413}, {-0.011820, 0.042940, 0.968881}}},
     {{{1.255528, -0.076749, -0.178779}, {-0.078411, 0.930809, 0.147602}, {0.004733, 0.691367, 0.303900}}}}};

constexpr std::size_t kFields = 8;

// A ΔE*ab of 2.3 is just noticeable side by side (Mahy et al. 1994); thin lines apart from each other need ten times
// that.
TEST(Palette, EightFieldsAreToldApartByEveryEye) {
    for (const Matrix& eye : kEyes) {
        for (std::size_t i = 0; i < kFields; ++i) {
            for (std::size_t k = 0; k < i; ++k) {
                const auto seen = [&](std::size_t field) {
                    Triple linear = product(eye, linear_rgb(field_line(field).colour));
                    std::ranges::for_each(linear, [](double& part) { part = std::clamp(part, 0.0, 1.0); });
                    return lab(linear);
                };
                EXPECT_GT(distance(seen(i), seen(k)), 23.0) << i << " and " << k << ", eye " << &eye - kEyes.data();
            }
        }
    }
}

// Lines on white need a contrast of 3 (WCAG 2.1, 1.4.11). Printed in grey, those of one stroke differ by a tenth of the
// range from black to white.
TEST(Palette, FieldsAreDarkEnoughAndToldApartInGrey) {
    for (std::size_t i = 0; i < kFields; ++i) {
        const FieldLine line = field_line(i);
        const Triple linear = linear_rgb(line.colour);
        EXPECT_GE(1.05 / (product(kToXyz, linear)[1] + 0.05), 3.0) << i;
        for (std::size_t k = 0; k < i; ++k) {
            if (std::string(field_line(k).dashes) == line.dashes) {
                EXPECT_GT(std::abs(lab(linear)[0] - lab(linear_rgb(field_line(k).colour))[0]), 10.0) << i << ", " << k;
            }
        }
    }
}

TEST(Palette, MoreFieldsThanColoursStillDiffer) {
    std::set<std::string> lines;
    for (std::size_t i = 0; i < 2 * kFields; ++i) {
        lines.insert(std::string(field_line(i).colour) + field_line(i).dashes);
    }
    EXPECT_EQ(lines.size(), 2 * kFields);
}

}  // namespace lensproof::draw::palette_test
