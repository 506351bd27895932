#include "engine/spectral/rgb_fit.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "engine/spectral/colour_matching.h"
#include "engine/spectral/illuminant.h"
#include "engine/spectral/sigmoid_spectrum.h"
#include "engine/spectral/wavelengths.h"

namespace lensproof::spectral {

namespace {

constexpr WavelengthStrata kStrata{.min_nm = 360.0, .max_nm = 830.0, .count = 470};  // as the observer is tabulated
constexpr int kStrataPerPanel = 10;
constexpr int kMostSteps = 30;
constexpr double kEnough = 1e-6;   // ΔE*ab
constexpr double kSteepest = 1e4;  // of a, b, c: reflectances are within 1e-8 of 0 and 1 there

/// What the parabola's colour misses in CIELAB, and how that changes with a, b, c.
struct Miss {
    Eigen::Vector3d lab;
    Eigen::Matrix3d per_coefficient;
};

/// d f / d t of CIELAB's cube root, which below (6/29)³ is a straight line.
double lightness_slope(double ratio) {
    constexpr double kDelta = 6.0 / 29.0;
    const double root = std::cbrt(ratio);
    return root > kDelta ? 1.0 / (3.0 * root * root) : 1.0 / (3.0 * kDelta * kDelta);
}

Miss miss(const RgbOfReflectance& colour, const Parabola& parabola, const Vec3d& target_lab) {
    Vec3d xyz;
    Vec3d per_a;
    Vec3d per_b;
    Vec3d per_c;
    const auto add = [](Vec3d& sum, double factor, const Vec3d& weight) {
        sum.x += factor * weight.x;
        sum.y += factor * weight.y;
        sum.z += factor * weight.z;
    };
    // The innermost of half a million steps.
    for (std::size_t i = 0; i < colour.abscissa.size(); ++i) {
        const double t = colour.abscissa[i];
        const Vec3d& weight = colour.xyz_weight[i];
        const double x = (parabola[0] * t + parabola[1]) * t + parabola[2];
        const double per_root = 1.0 / std::sqrt(1.0 + x * x);
        const double slope = 0.5 * per_root * per_root * per_root;
        add(xyz, 0.5 + 0.5 * x * per_root, weight);
        add(per_a, slope * t * t, weight);
        add(per_b, slope * t, weight);
        add(per_c, slope, weight);
    }
    const std::array<Vec3d, 3> slope{per_a, per_b, per_c};
    const Vec3d lab = cielab(xyz, colour.white);
    Miss result;
    result.lab << lab.x - target_lab.x, lab.y - target_lab.y, lab.z - target_lab.z;
    for (Eigen::Index k = 0; k < 3; ++k) {
        const Vec3d& d = slope[static_cast<std::size_t>(k)];
        const double x = lightness_slope(xyz.x / colour.white.x) * d.x / colour.white.x;
        const double y = lightness_slope(xyz.y / colour.white.y) * d.y / colour.white.y;
        const double z = lightness_slope(xyz.z / colour.white.z) * d.z / colour.white.z;
        result.per_coefficient.col(k) << 116.0 * y, 500.0 * (x - y), 200.0 * (y - z);
    }
    return result;
}

}  // namespace

RgbOfReflectance rgb_of_reflectance() {
    const auto& [x_bar, y_bar, z_bar] = cie_1931();
    const Spectrum light = illuminant("D65").relative;
    constexpr int kPanels = kStrata.count / kStrataPerPanel;
    RgbOfReflectance colour;
    for (int i = 0; i <= 2 * kPanels; ++i) {
        colour.abscissa.push_back(sigmoid_abscissa(kStrata.at(i * kStrataPerPanel / 2, 0.0)));
    }
    colour.xyz_weight.resize(colour.abscissa.size());
    for (int i = 0; i < kStrata.count; ++i) {
        const double nm = kStrata.midpoint(i);
        const Vec3d weight = light(nm) * Vec3d{x_bar(nm), y_bar(nm), z_bar(nm)};
        // A reflectance as the parabola through its values at the panel's ends and middle, u = −1, 1 and 0.
        const double u = (i % kStrataPerPanel + 0.5) / (0.5 * kStrataPerPanel) - 1.0;
        const int first = i / kStrataPerPanel * 2;
        Vec3d* const panel = &colour.xyz_weight[static_cast<std::size_t>(first)];
        panel[0] = panel[0] + 0.5 * u * (u - 1.0) * weight;
        panel[1] = panel[1] + (1.0 - u) * (1.0 + u) * weight;
        panel[2] = panel[2] + 0.5 * u * (u + 1.0) * weight;
        colour.white = colour.white + weight;
    }
    for (Vec3d& weight : colour.xyz_weight) {
        weight = 1.0 / colour.white.y * weight;
    }
    colour.white = 1.0 / colour.white.y * colour.white;
    colour.primary = rec709_primaries(colour.white);
    return colour;
}

Vec3d xyz_of(const RgbOfReflectance& colour, const Parabola& parabola) {
    Vec3d xyz;
    for (std::size_t i = 0; i < colour.abscissa.size(); ++i) {
        const double t = colour.abscissa[i];
        xyz = xyz + sigmoid((parabola[0] * t + parabola[1]) * t + parabola[2]) * colour.xyz_weight[i];
    }
    return xyz;
}

Vec3d xyz_of_rgb(const RgbOfReflectance& colour, const Vec3d& rgb) {
    return rgb.x * colour.primary[0] + rgb.y * colour.primary[1] + rgb.z * colour.primary[2];
}

double missed_by(const RgbOfReflectance& colour, const Vec3d& rgb, const Parabola& parabola) {
    return length(cielab(xyz_of(colour, parabola), colour.white) - cielab(xyz_of_rgb(colour, rgb), colour.white));
}

Parabola fitted_parabola(const RgbOfReflectance& colour, const Vec3d& rgb, const Parabola& guess) {
    const Vec3d target = cielab(xyz_of_rgb(colour, rgb), colour.white);
    Parabola best = guess;
    Miss at_best = miss(colour, best, target);
    double damping = 1e-4;
    for (int step = 0; step < kMostSteps && at_best.lab.norm() > kEnough; ++step) {
        Eigen::Matrix3d normal = at_best.per_coefficient.transpose() * at_best.per_coefficient;
        normal.diagonal() *= 1.0 + damping;
        const Eigen::Vector3d change = normal.ldlt().solve(at_best.per_coefficient.transpose() * at_best.lab);
        const Parabola next{best[0] - change[0], best[1] - change[1], best[2] - change[2]};
        const Miss at_next = miss(colour, next, target);
        const double steepness = std::max({std::abs(next[0]), std::abs(next[1]), std::abs(next[2])});
        if (at_next.lab.norm() < at_best.lab.norm() && steepness < kSteepest) {  // false for NaN too
            best = next;
            at_best = at_next;
            damping = std::max(1e-12, 0.1 * damping);
        } else {
            damping *= 10.0;
        }
    }
    return best;
}

}  // namespace lensproof::spectral
