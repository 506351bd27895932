// experiments/studies/tradeoff/point_sums.h — what the rays of one point of light add up to.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>

#include "engine/base/vec.h"

namespace lensproof::studies {

/// Sums over the rays of a point: weights, where they land from the point's pixel, and squares of that.
struct Landing {
    double light = 0.0;
    Vec2d moment;
    double second_moment = 0.0;

    void add(double weight, Vec2d from_pixel) {
        light += weight;
        moment = moment + weight * from_pixel;
        second_moment += weight * (from_pixel.x * from_pixel.x + from_pixel.y * from_pixel.y);
    }
    void add(const Landing& more) {
        light += more.light;
        moment = moment + more.moment;
        second_moment += more.second_moment;
    }
    [[nodiscard]] Vec2d centroid() const { return (1.0 / light) * moment; }
    [[nodiscard]] double spread() const {
        const Vec2d c = centroid();
        return std::sqrt(std::max(0.0, second_moment / light - (c.x * c.x + c.y * c.y)));
    }
};

/// The transform of a point's image at one spatial frequency, summed over rays: along two directions, each of which is
/// that of its line spread. Its modulus over the light is the geometric MTF, which knows no diffraction
/// (Hopkins, Proc. Phys. Soc. B 70, 1957, 1162).
struct Modulation {
    double light = 0.0;
    std::array<std::complex<double>, 2> wave{};

    /// `cycles`: where the ray lands in either direction, times the frequency.
    void add(double weight, Vec2d cycles) {
        light += weight;
        wave[0] += std::polar(weight, -2.0 * std::numbers::pi * cycles.x);
        wave[1] += std::polar(weight, -2.0 * std::numbers::pi * cycles.y);
    }
    void add(const Modulation& more) {
        light += more.light;
        wave[0] += more.wave[0];
        wave[1] += more.wave[1];
    }
    [[nodiscard]] double mtf(std::size_t direction) const { return std::abs(wave[direction]) / light; }
};

using Landings = std::array<Landing, 3>;  // in R, G and B

/// Of both cameras, at one point.
struct PointSums {
    Landings exact;
    Landings model;
    Modulation exact_modulation;  // in green
    Modulation model_modulation;
    double ray_square = 0.0;  // px², times weights
    double ray_light = 0.0;
    double lost_light = 0.0;
    double even_exact = 0.0;
    double even_model = 0.0;

    PointSums& operator+=(const PointSums& more) {
        for (std::size_t c = 0; c < 3; ++c) {
            exact[c].add(more.exact[c]);
            model[c].add(more.model[c]);
        }
        exact_modulation.add(more.exact_modulation);
        model_modulation.add(more.model_modulation);
        ray_square += more.ray_square;
        ray_light += more.ray_light;
        lost_light += more.lost_light;
        even_exact += more.even_exact;
        even_model += more.even_model;
        return *this;
    }
};

}  // namespace lensproof::studies
