// Polarisation along a path: against closed forms, conservation, and the unpolarised product where planes coincide.
#include "engine/optics/polarisation.h"

#include <gtest/gtest.h>

#include <numbers>
#include <random>

#include "engine/optics/refract.h"

namespace lensproof::optics::polarisation_test {

const TraceCoating<double> kStack{.layers = {{1.38, 0.21}, {2.1, 0.13}, {1.63, 0.2}}};

Vec3d refracted(const Vec3d& direction, const Vec3d& normal, double ratio) {
    const Vec3d along = dot(direction, normal) > 0.0 ? normal : -1.0 * normal;
    return refract(direction, along, dot(direction, along), ratio).direction;
}

/// Through a plate of index 1.6 in air, coated in front, whose normal is given.
void cross_plate(PolarisedPath<double>& path, const Vec3d& normal) {
    path.refract(kStack, 1.0, 1.6, true, normal, refracted(path.direction(), normal, 1.0 / 1.6));
    path.refract({}, 1.6, 1.0, true, normal, refracted(path.direction(), normal, 1.6));
}

/// Its powers for s and p at 0.9 rad.
struct PlatePowers {
    double s;
    double p;
};
PlatePowers plate_powers() {
    const double inside = std::sqrt(1.0 - std::pow(std::sin(0.9) / 1.6, 2));
    const PolarisedPowers<double> front = coating_powers(kStack, 1.0, 1.6, std::cos(0.9), true);
    const PolarisedPowers<double> rear = coating_powers<double>({}, 1.6, 1.0, inside, true);
    return {front.s.transmitted * rear.s.transmitted, front.p.transmitted * rear.p.transmitted};
}

Vec3d unit_towards(std::mt19937& random) {
    std::uniform_real_distribution<double> part(-1.0, 1.0);
    return normalized(Vec3d{part(random), part(random), part(random)});
}

// Two plates tilted by 0.9 rad, whose planes of incidence are at an angle φ. As a partial polariser before another one
// (Malus's law for both axes): ((S² + P²) cos² φ + 2 S P sin² φ) / 2, of unpolarised light. Crossed planes give S P,
// parallel ones the mean of the two products, and only where S = P the product of the means.
TEST(Polarisation, TwoTiltedPlates) {
    const auto [s, p] = plate_powers();
    const auto tilted = [](double azimuth) {
        return Vec3d{std::sin(0.9) * std::cos(azimuth), std::sin(0.9) * std::sin(azimuth), std::cos(0.9)};
    };
    for (const double first : {0.0, 0.4, 2.0}) {
        for (const double between : {0.0, 0.3, 0.7, std::numbers::pi / 2.0, 2.5}) {
            PolarisedPath<double> path({0.0, 0.0, 1.0});
            cross_plate(path, tilted(first));
            EXPECT_NEAR(path.transmittance({-std::sin(first), std::cos(first), 0.0}), s, 1e-14);
            EXPECT_NEAR(path.transmittance({std::cos(first), std::sin(first), 0.0}), p, 1e-14);
            EXPECT_NEAR(path.transmittance(), (s + p) / 2.0, 1e-14);
            cross_plate(path, tilted(first + between));
            const double cos2 = std::pow(std::cos(between), 2);
            EXPECT_NEAR(path.transmittance(), ((s * s + p * p) * cos2 + 2.0 * s * p * (1.0 - cos2)) / 2.0, 1e-14);
        }
    }
    EXPECT_GT(std::abs(s - p), 0.1);  // or it would say nothing
}

// Where all planes coincide s stays s: two products, whose mean is above the product of the means where both surfaces
// favour the same polarisation.
TEST(Polarisation, InOnePlaneEachPolarisationStaysItself) {
    PolarisedPath<double> path(normalized(Vec3d{0.0, 0.2, 1.0}));
    double s = 1.0;
    double p = 1.0;
    double unpolarised = 1.0;
    double before = 1.0;
    for (const auto& [tilt, behind] : {std::pair{0.5, 1.7}, {-0.3, 1.5}, {-0.1, 1.0}, {0.6, 1.8}}) {
        const Vec3d normal{0.0, std::sin(tilt), std::cos(tilt)};
        const PolarisedPowers<double> powers =
            coating_powers(kStack, before, behind, dot(path.direction(), normal), true);
        s *= powers.s.transmitted;
        p *= powers.p.transmitted;
        unpolarised *= powers.unpolarised().transmitted;
        path.refract(kStack, before, behind, true, normal, refracted(path.direction(), normal, before / behind));
        before = behind;
    }
    EXPECT_NEAR(path.transmittance({1.0, 0.0, 0.0}), s, 1e-14);
    EXPECT_NEAR(path.transmittance(), (s + p) / 2.0, 1e-14);
    EXPECT_GT(path.transmittance(), unpolarised);
}

// What a surface without absorption passes and reflects of any polarisation, elliptical ones included, is all of it;
// fields stay at right angles to the ray. After three surfaces in skew planes, from both sides, near normal incidence
// and beyond the critical angle.
TEST(Polarisation, LosesNothingAtSkewSurfaces) {
    std::mt19937 random(4);
    int total = 0;
    for (int i = 0; i < 2000; ++i) {
        PolarisedPath<double> path(unit_towards(random));
        const Vec3d x = normalized(cross(path.direction(), unit_towards(random)));
        const Vec3d y = cross(path.direction(), x);
        const std::complex<double> a(0.6, 0.3);
        const std::complex<double> b(-0.2, 0.7);
        const PolarisedPath<double>::Field field{a * x.x + b * y.x, a * x.y + b * y.y, a * x.z + b * y.z};
        const auto power = [](const PolarisedPath<double>::Field& f) {
            return std::norm(f[0]) + std::norm(f[1]) + std::norm(f[2]);
        };
        double left = power(field);
        for (int surface = 0; surface < 3; ++surface) {
            Vec3d normal = unit_towards(random);
            if (i % 4 == 0) {
                normal = path.direction() + 1e-9 * normal;
            }
            const bool from_scene = i % 2 == 0;
            const double near = from_scene ? 1.0 : 1.6;
            const double far = from_scene ? 1.6 : 1.0;
            const double cosine = std::abs(dot(path.direction(), normal)) / length(normal);
            PolarisedPath<double> back = path;
            back.reflect(kStack, 1.0, 1.6, from_scene, normal);
            const double reflected = power(back.field(field));
            if (is_beyond_critical(1.0, 1.6, cosine, from_scene)) {
                EXPECT_NEAR(reflected, left, 1e-13);
                ++total;
                path = back;
                continue;
            }
            path.refract(kStack, 1.0, 1.6, from_scene, normal,
                         refracted(path.direction(), normalized(normal), near / far));
            const auto after = path.field(field);
            EXPECT_NEAR(reflected + power(after), left, 1e-13);
            const Vec3d& k = path.direction();
            EXPECT_NEAR(std::abs(after[0] * k.x + after[1] * k.y + after[2] * k.z), 0.0, 1e-13);
            left = power(after);
        }
        EXPECT_NEAR((path.transmittance(x) + path.transmittance(y)) / 2.0, path.transmittance(), 1e-13);
    }
    EXPECT_GT(total, 100);
}

// A rotation of everything rotates the field and changes no power.
TEST(Polarisation, KnowsNoPreferredAxis) {
    std::mt19937 random(6);
    for (int i = 0; i < 200; ++i) {
        const Vec3d z = unit_towards(random);
        const Vec3d x = normalized(cross(z, unit_towards(random)));
        const Vec3d y = cross(z, x);
        const auto turned = [&](const Vec3d& v) { return v.x * x + v.y * y + v.z * z; };
        PolarisedPath<double> path({0.0, 0.0, 1.0});
        PolarisedPath<double> other(turned({0.0, 0.0, 1.0}));
        for (int surface = 0; surface < 3; ++surface) {
            const Vec3d normal = normalized(Vec3d{0.0, 0.0, 1.5} + unit_towards(random));
            const Vec3d after = refracted(path.direction(), normal, 1.0 / 1.4);
            path.refract(kStack, 1.0, 1.4, true, normal, after);
            other.refract(kStack, 1.0, 1.4, true, turned(normal), turned(after));
        }
        EXPECT_NEAR(path.transmittance(), other.transmittance(), 1e-14);
        EXPECT_NEAR(path.transmittance({1.0, 0.0, 0.0}), other.transmittance(x), 1e-14);
    }
}

}  // namespace lensproof::optics::polarisation_test
