// What thin films do to light, held to closed forms, to another method, to another program and to conservation laws.
#include "engine/optics/coating.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <limits>
#include <numbers>
#include <random>
#include <sstream>

#include "engine/base/angle.h"
#include "engine/base/csv.h"
#include "engine/base/pack.h"
#include "engine/optics/coating_amplitudes.h"
#include "engine/optics/multiprecision.h"
#include "engine/optics/refract.h"
#include "tests/places.h"

namespace lensproof::optics::coating_test {

constexpr double kAngles[] = {0.0, 0.3, 0.8, 1.2, 1.5};

template <class T>
T transmittance(const TraceCoating<T>& coating, double n1, double n2, double angle) {
    return coating_transmittance(coating, T(n1), T(n2), T(std::cos(angle)), true);
}

double bare_transmittance(double n1, double n2, double angle) {
    const double sine = n1 * std::sin(angle) / n2;
    return fresnel_transmittance(n1 / n2, std::cos(angle), std::sqrt(1.0 - sine * sine)).value();
}

/// Up to `most` layers of any thickness up to two wavelengths; of those that absorb, some are metals.
TraceCoating<double> random_stack(std::mt19937& random, int most, bool absorbs) {
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    TraceCoating<double> stack;
    const int count = 1 + static_cast<int>(most * unit(random));
    for (int i = 0; i < count; ++i) {
        const bool is_metal = absorbs && unit(random) < 0.2;
        stack.layers.push_back({.index = is_metal ? 0.05 + 3.0 * unit(random) : 1.05 + 2.5 * unit(random),
                                .thickness = (is_metal ? 0.05 : 2.0) * unit(random),
                                .extinction = is_metal  ? 5.0 * unit(random)
                                              : absorbs ? 0.2 * unit(random)
                                                        : 0.0});
    }
    return stack;
}

struct Incidence {
    double n1;
    double n2;
    double cosine;
    bool from_scene_side;
};

/// From grazing to normal, from within the critical angle and beyond it.
Incidence random_incidence(std::mt19937& random) {
    constexpr double kIndices[] = {1.0, 1.33, 1.52, 1.9};
    std::uniform_int_distribution<int> any(0, 3);
    const double cosine = std::uniform_real_distribution<double>(1e-3, 1.0)(random);
    const double n1 = kIndices[any(random)];
    const double n2 = kIndices[any(random)];
    return {n1, n2, cosine, any(random) % 2 == 0};
}

PolarisedPowers<double> powers_of(const TraceCoating<double>& stack, const Incidence& at) {
    return coating_powers(stack, at.n1, at.n2, at.cosine, at.from_scene_side);
}

// A layer of either medium's own index is not there, nor is one of half a wave at normal incidence.
TEST(Coating, LayersThatDoNothing) {
    for (const double angle : kAngles) {
        const double bare = bare_transmittance(1.0, 1.6, angle);
        EXPECT_NEAR(transmittance<double>({.layers = {{1.6, 0.37}}}, 1.0, 1.6, angle), bare, 1e-14);
        EXPECT_NEAR(transmittance<double>({.layers = {{1.0, 0.37}}}, 1.0, 1.6, angle), bare, 1e-14);
        EXPECT_NEAR(transmittance<double>({.layers = {{1.6, 0.2}, {1.6, 1.9}}}, 1.0, 1.6, angle), bare, 1e-14);
    }
    EXPECT_NEAR(transmittance<double>({.layers = {{2.3, 0.5 / 2.3}}}, 1.0, 1.6, 0.0), bare_transmittance(1.0, 1.6, 0.0),
                1e-14);
}

// Without layers: Fresnel's amplitudes and powers (Born & Wolf, §1.5.2, eqs. 20 and 21), to a few roundings.
TEST(Coating, WithoutLayersIsFresnels) {
    for (const double angle : kAngles) {
        for (const auto& [n1, n2] : {std::pair{1.0, 1.52}, {1.9, 1.91}, {1.52, 1.52}}) {
            const double c1 = std::cos(angle);
            const double c2 = std::sqrt((n2 - n1) * (n2 + n1) + n1 * n1 * c1 * c1) / n2;  // which cancels nothing
            const CoatedAmplitudes<double> bare = coating_amplitudes<double>({}, n1, n2, c1, true);
            EXPECT_NEAR(bare.r_s.real(), (n1 * c1 - n2 * c2) / (n1 * c1 + n2 * c2), 2e-15);
            EXPECT_NEAR(bare.r_p.real(), (n2 * c1 - n1 * c2) / (n2 * c1 + n1 * c2), 2e-15);
            EXPECT_NEAR(bare.t_s.real(), 2.0 * n1 * c1 / (n1 * c1 + n2 * c2), 2e-15);
            EXPECT_NEAR(bare.t_p.real(), 2.0 * n1 * c1 / (n2 * c1 + n1 * c2), 2e-15);
            EXPECT_NEAR(coating_transmittance<double>({}, n1, n2, c1, true),
                        fresnel_transmittance(n1 / n2, c1, c2).value(), 4e-15);
        }
    }
}

// A quarter-wave layer reflects ((n₁ n₃ − n²) / (n₁ n₃ + n²))² at normal incidence (Macleod, §2.6): nothing where
// n² = n₁ n₃.
TEST(Coating, QuarterWaveLayer) {
    for (const double n : {1.2, 1.38, std::sqrt(1.6), 2.1}) {
        const double amplitude = (1.6 - n * n) / (1.6 + n * n);
        EXPECT_NEAR(transmittance<double>({.layers = {{n, 0.25 / n}}}, 1.0, 1.6, 0.0), 1.0 - amplitude * amplitude,
                    1e-14);
    }
}

// Reflectances in % that were computed with 30 digits for this project, in all the digits that they were written down
// with.
TEST(Coating, KnownFilms) {
    const auto percent = [](const std::vector<TraceCoating<double>::Layer>& layers_nm, double n2, double nm,
                            double angle_deg) {
        TraceCoating<double> coating{.layers = layers_nm};
        for (auto& layer : coating.layers) {
            layer.thickness /= nm;
        }
        const PolarisedPowers<double> powers = coating_powers(coating, 1.0, n2, std::cos(radians(angle_deg)), true);
        return std::array{100.0 * powers.unpolarised().reflected, 100.0 * powers.s.reflected,
                          100.0 * powers.p.reflected};
    };
    const std::vector<TraceCoating<double>::Layer> quarter = {{1.38, 550.0 / 4.0 / 1.38}};
    EXPECT_NEAR(percent({}, 1.5168, 550.0, 0.0)[0], 4.216456, 5e-7);
    EXPECT_NEAR(percent(quarter, 1.5168, 550.0, 0.0)[0], 1.283544, 5e-7);
    for (const auto& [nm, expected] : {std::pair{400.0, 2.2078},
                                       {450.0, 1.6359},
                                       {500.0, 1.3575},
                                       {600.0, 1.3350},
                                       {650.0, 1.4564},
                                       {700.0, 1.6122}}) {
        EXPECT_NEAR(percent(quarter, 1.5168, nm, 0.0)[0], expected, 5e-5) << nm;
    }
    EXPECT_NEAR(percent(quarter, 1.5168, 550.0, 30.0)[0], 1.40597, 5e-6);
    EXPECT_NEAR(percent(quarter, 1.5168, 550.0, 45.0)[0], 2.09364, 5e-6);
    EXPECT_NEAR(percent(quarter, 1.5168, 550.0, 45.0)[1], 4.04791, 5e-6);
    EXPECT_NEAR(percent(quarter, 1.5168, 550.0, 45.0)[2], 0.13936, 5e-6);
    EXPECT_NEAR(percent(quarter, 1.5168, 550.0, 60.0)[0], 5.36862, 5e-6);
    EXPECT_NEAR(percent(quarter, 1.52, 550.0, 0.0)[0], 1.260079, 5e-7);
    EXPECT_NEAR(percent(quarter, 1.62041, 550.0, 0.0)[0], 0.649134, 5e-7);
    EXPECT_NEAR(percent(quarter, 1.7847, 550.0, 0.0)[0], 0.105280, 5e-7);
    // Two layers with a zero; half of the last digit of a thickness, 0.5 pm, makes r = 2π · 1e-6 · 2.1 at most.
    EXPECT_LT(percent({{1.38, 126.520}, {2.10, 17.579}}, 1.52, 550.0, 0.0)[0], 1e-7);
    EXPECT_LT(percent({{1.38, 72.755}, {2.10, 113.373}}, 1.52, 550.0, 0.0)[0], 1e-7);
}

/// The same by the sum over multiple reflections, layer by layer (Airy 1833; Rouard 1937): waves in the place of
/// fields. With a hundred digits it is exact.
struct SummedReflections {
    using T = Multiprecision;
    using Complex = std::complex<T>;
    Complex r;
    Complex t;
    T transmitted;

    SummedReflections(const TraceCoating<double>& stack, const Incidence& at, bool s) {
        const Complex near(T(at.from_scene_side ? at.n1 : at.n2));
        const Complex far(T(at.from_scene_side ? at.n2 : at.n1));
        std::vector<Complex> n{near};
        std::vector<T> d{T(0)};
        for (const auto& layer : stack.layers) {
            n.emplace_back(T(layer.index), T(layer.extinction));
            d.emplace_back(layer.thickness);
        }
        n.push_back(far);
        d.emplace_back(0);
        if (!at.from_scene_side) {
            std::reverse(n.begin() + 1, n.end() - 1);
            std::reverse(d.begin() + 1, d.end() - 1);
        }
        const T cosine(at.cosine);
        const Complex sine_squared = near * near * (T(1) - cosine * cosine);
        std::vector<Complex> q;
        for (const Complex& index : n) {
            q.push_back(sqrt(index * index - sine_squared));
            if (q.back().imag() < T(0)) {
                q.back() = -q.back();
            }
        }
        const auto eta = [&](std::size_t i) { return s ? q[i] : q[i] / (n[i] * n[i]); };
        r = Complex(T(0));
        t = Complex(T(1));
        for (std::size_t i = n.size() - 1; i > 0; --i) {
            const Complex single_r = (eta(i - 1) - eta(i)) / (eta(i - 1) + eta(i));
            const Complex single_t = T(2) * eta(i - 1) / (eta(i - 1) + eta(i));
            const T k = T(2) * acos(T(-1)) * d[i];
            const T decay = exp(-k * q[i].imag());
            const T turn = k * q[i].real();
            const Complex across(decay * cos(turn), decay * sin(turn));
            const Complex there = across * across * r;
            t = single_t * across * t / (T(1) + single_r * there);
            r = (single_r + there) / (T(1) + single_r * there);
        }
        transmitted = std::norm(t) * eta(n.size() - 1).real() / eta(0).real();
        if (!s) {
            t *= near / far;  // from magnetic fields to electric ones
        }
    }
};

double distance(const std::complex<double>& a, const std::complex<Multiprecision>& b) {
    return static_cast<double>(
        std::abs(std::complex<Multiprecision>(Multiprecision(a.real()), Multiprecision(a.imag())) - b));
}

// Both polarisations and sides, metals among the layers, angles near grazing and beyond the critical one. 1e-12: twenty
// layers of 20 roundings each, where phases up to 2π · 2 · 3.5 carry their own, leave 1e-13 typically; beside a
// resonance of a stack more, relative to the amplitude.
TEST(Coating, AgreesWithTheSumOfReflections) {
    std::mt19937 random(3);
    for (int i = 0; i < 150; ++i) {
        const TraceCoating<double> stack = random_stack(random, 20, i % 3 != 0);
        const Incidence at = random_incidence(random);
        const CoatedAmplitudes<double> found = coating_amplitudes(stack, at.n1, at.n2, at.cosine, at.from_scene_side);
        const PolarisedPowers<double> powers = powers_of(stack, at);
        const SummedReflections s(stack, at, true);
        const SummedReflections p(stack, at, false);
        EXPECT_LT(distance(found.r_s, s.r), 1e-12);
        EXPECT_LT(distance(found.r_p, p.r), 1e-12);
        EXPECT_LT(distance(found.t_s, s.t), 1e-12 * (1.0 + std::abs(found.t_s)));
        EXPECT_LT(distance(found.t_p, p.t), 1e-12 * (1.0 + std::abs(found.t_p)));
        EXPECT_NEAR(powers.s.transmitted, static_cast<double>(s.transmitted), 1e-12);
        EXPECT_NEAR(powers.p.transmitted, static_cast<double>(p.transmitted), 1e-12);
        EXPECT_NEAR(powers.s.reflected, static_cast<double>(std::norm(s.r)), 1e-12);
        EXPECT_NEAR(powers.p.reflected, static_cast<double>(std::norm(p.r)), 1e-12);
    }
}

// What the tmm package says of 120 stacks (make_thin_films.py beside the file).
TEST(Coating, AgreesWithTmm) {
    CsvTable table = CsvTable::read(reference_numbers_folder() / "thin_films.csv");
    int rows = 0;
    while (const std::optional<CsvRow> row = table.next()) {
        TraceCoating<double> stack;
        std::istringstream layers(row->text("layers"));
        double n = 0.0;
        double k = 0.0;
        double d = 0.0;
        for (char colon = ':'; layers >> n >> colon >> k >> colon >> d;) {
            stack.layers.push_back({.index = n, .thickness = d, .extinction = k});
        }
        const Incidence at{row->number("n1"), row->number("n2"), std::cos(row->number("angle_rad")), true};
        const CoatedAmplitudes<double> found = coating_amplitudes(stack, at.n1, at.n2, at.cosine, true);
        const PolarisedPowers<double> powers = powers_of(stack, at);
        for (const auto& [name, amplitude] :
             {std::pair{"r_s", found.r_s}, {"r_p", found.r_p}, {"t_s", found.t_s}, {"t_p", found.t_p}}) {
            EXPECT_NEAR(amplitude.real(), row->number(std::string(name) + "_re"), 1e-12) << row->where(name);
            EXPECT_NEAR(amplitude.imag(), row->number(std::string(name) + "_im"), 1e-12) << row->where(name);
        }
        EXPECT_NEAR(powers.s.reflected, row->number("R_s"), 1e-12);
        EXPECT_NEAR(powers.s.transmitted, row->number("T_s"), 1e-12);
        EXPECT_NEAR(powers.p.reflected, row->number("R_p"), 1e-12);
        EXPECT_NEAR(powers.p.transmitted, row->number("T_p"), 1e-12);
        ++rows;
    }
    EXPECT_EQ(rows, 120);
}

// Without absorption R + T = 1, at any stack, angle and side; beyond the critical angle R alone is.
TEST(Coating, LosesNothingWithoutAbsorption) {
    std::mt19937 random(1);
    int beyond = 0;
    for (int i = 0; i < 20000; ++i) {
        const Incidence at = random_incidence(random);
        const PolarisedPowers<double> powers = powers_of(random_stack(random, 40, false), at);
        for (const CoatedPowers<double>& of : {powers.s, powers.p}) {
            EXPECT_NEAR(of.absorbed(), 0.0, 1e-12);
            EXPECT_GE(of.transmitted, 0.0);
        }
        if (is_beyond_critical(at.n1, at.n2, at.cosine, at.from_scene_side)) {
            EXPECT_EQ(powers.s.transmitted, 0.0);
            EXPECT_EQ(powers.p.transmitted, 0.0);
            ++beyond;
        }
    }
    EXPECT_GT(beyond, 1000);
}

/// The power that each layer takes up, from the fields within it: the fall of the flux Re(E × H*) across it, by the
/// fields of two waves matched at its far side, over the incoming flux. Another road than 1 − R − T.
double absorbed_within(const TraceCoating<double>& stack, const Incidence& at, bool s) {
    using Complex = std::complex<Multiprecision>;
    using T = Multiprecision;
    const T n1(at.n1);
    const T n2(at.n2);
    const T q1 = n1 * T(at.cosine);
    const T sine_squared = n1 * n1 - q1 * q1;
    const auto q_of = [&](const Complex& n) { return sqrt(n * n - sine_squared); };
    const Complex q2 = q_of(Complex(n2));
    Complex first(T(1));
    Complex second = s ? q2 : q2 / (n2 * n2);
    T taken(0);
    const auto flux = [&] { return (first * std::conj(second)).real(); };
    for (auto layer = stack.layers.rbegin(); layer != stack.layers.rend(); ++layer) {
        const Complex n(T(layer->index), T(layer->extinction));
        const Complex q = q_of(n);
        const Complex eta = s ? q : q / (n * n);
        const T before = flux();
        const Complex on = (first + second / eta) / T(2);
        const Complex back = (first - second / eta) / T(2);
        const T k = T(2) * acos(T(-1)) * T(layer->thickness);
        const Complex phase = Complex(T(0), k) * q;
        const Complex on_there = on * exp(-phase);
        const Complex back_there = back * exp(phase);
        first = on_there + back_there;
        second = eta * (on_there - back_there);
        taken += flux() - before;
    }
    const T eta1 = s ? q1 : q1 / (n1 * n1);
    const T incoming = std::norm(eta1 * first + second) / (T(4) * eta1);
    return static_cast<double>(taken / incoming);
}

// R + T + A = 1, A summed over what the layers take up.
TEST(Coating, WhatIsMissingIsTakenUpInTheLayers) {
    std::mt19937 random(5);
    for (int i = 0; i < 60; ++i) {
        const TraceCoating<double> stack = random_stack(random, 10, true);
        Incidence at = random_incidence(random);
        at.from_scene_side = true;
        const PolarisedPowers<double> powers = powers_of(stack, at);
        EXPECT_NEAR(powers.s.absorbed(), absorbed_within(stack, at, true), 1e-12);
        EXPECT_NEAR(powers.p.absorbed(), absorbed_within(stack, at, false), 1e-12);
        EXPECT_GE(powers.s.absorbed(), -1e-14);
        EXPECT_GE(powers.p.absorbed(), -1e-14);
    }
}

// T is the same from both sides (reciprocity), with absorption too, while R need not be; and without absorption
// Stokes's relations hold: t₁₂ q₂ / q₁ = t₂₁, r₂₁ = −r₁₂* t₁₂ / t₁₂* (q = n cos θ on the two sides). The two angles are
// rounded apart, in phases of up to 500 rad: 1e-11.
TEST(Coating, ReciprocityAndStokesRelations) {
    std::mt19937 random(2);
    int differ = 0;
    int compared = 0;
    for (int i = 0; i < 4000; ++i) {
        const bool absorbs = i % 2 == 0;
        const TraceCoating<double> stack = random_stack(random, 12, absorbs);
        const Incidence at = random_incidence(random);
        if (is_beyond_critical(at.n1, at.n2, at.cosine, true)) {
            continue;
        }
        const double q1 = at.n1 * at.cosine;
        const double q2 = std::sqrt(at.n2 * at.n2 - at.n1 * at.n1 + q1 * q1);
        const double cos2 = q2 / at.n2;
        if (cos2 < 0.05) {
            continue;  // q from a cosine that was rounded: 1e-16 / cos²
        }
        ++compared;
        const CoatedAmplitudes<double> there = coating_amplitudes(stack, at.n1, at.n2, at.cosine, true);
        const CoatedAmplitudes<double> back = coating_amplitudes(stack, at.n1, at.n2, cos2, false);
        EXPECT_NEAR(std::abs(there.t_s * (q2 / q1) - back.t_s), 0.0, 1e-11 * (1.0 + std::abs(back.t_s)));
        EXPECT_NEAR(std::abs(there.t_p * (q2 / q1) - back.t_p), 0.0, 1e-11 * (1.0 + std::abs(back.t_p)));
        EXPECT_NEAR(coating_transmittance(stack, at.n1, at.n2, at.cosine, true),
                    coating_transmittance(stack, at.n1, at.n2, cos2, false), 1e-11);
        if (absorbs) {
            differ += std::abs(std::norm(there.r_s) - std::norm(back.r_s)) > 1e-3 ? 1 : 0;
            continue;
        }
        EXPECT_NEAR(std::abs(back.r_s + std::conj(there.r_s) * there.t_s / std::conj(there.t_s)), 0.0, 1e-11);
        EXPECT_NEAR(std::abs(back.r_p + std::conj(there.r_p) * there.t_p / std::conj(there.t_p)), 0.0, 1e-11);
    }
    EXPECT_GT(compared, 2000);
    EXPECT_GT(differ, 500);
}

// Light tunnels through a thin gap beyond the critical angle: 1/T = 1 + ((η₁² + g²) / (2 η₁ g))² sinh²(2π d |q|), with
// g the gap's |η| (Born & Wolf, §1.5.4, on the frustration of total reflection), until the gap is some waves wide.
TEST(Coating, TunnelsThroughThinGaps) {
    const double angle = 0.9;  // from 1.6 into air: critical at 0.675
    const double q = 1.6 * std::cos(angle);
    const double fall = std::sqrt(1.6 * 1.6 - q * q - 1.0);
    for (const double gap : {0.01, 0.1, 0.5, 1.0, 3.0}) {
        const PolarisedPowers<double> powers =
            coating_powers<double>({.layers = {{1.0, gap}}}, 1.6, 1.6, std::cos(angle), true);
        const double sinh = std::sinh(2.0 * std::numbers::pi * gap * fall);
        const auto expected = [&](double eta, double g) {
            return 1.0 / (1.0 + std::pow((eta * eta + g * g) / (2.0 * eta * g) * sinh, 2));
        };
        EXPECT_NEAR(powers.s.transmitted / expected(q, fall), 1.0, 1e-12);
        EXPECT_NEAR(powers.p.transmitted / expected(q / 1.6 / 1.6, fall), 1.0, 1e-12);
        EXPECT_NEAR(powers.s.reflected, 1.0 - expected(q, fall), 1e-14);
    }
    EXPECT_EQ(transmittance<double>({.layers = {{1.0, 1e6}}}, 1.6, 1.6, angle), 0.0);
}

// Thick metal is the metal itself: r of its bulk, and nothing behind it. Its matrix alone would overflow.
TEST(Coating, ThickMetalIsItsBulk) {
    const std::complex<double> n(0.13, 3.3);  // silver's at 550 nm, about
    for (const double angle : kAngles) {
        for (const double thickness : {10.0, 1e3, 1e9}) {
            const TraceCoating<double> metal{.layers = {{1.38, 0.2}, {n.real(), thickness, n.imag()}, {1.5, 0.3}}};
            const TraceCoating<double> bulk{.layers = {{1.38, 0.2}}};
            const CoatedAmplitudes<double> found = coating_amplitudes(metal, 1.0, 1.5, std::cos(angle), true);
            // Airy's sum of the film's two sides, the second one against the bulk.
            const double sine = std::sin(angle);
            const std::array<std::complex<double>, 3> q = {std::complex<double>(std::cos(angle)),
                                                           std::sqrt(std::complex<double>(1.38 * 1.38 - sine * sine)),
                                                           std::sqrt(n * n - sine * sine)};
            const auto r = [](const std::complex<double>& a, const std::complex<double>& b) {
                return (a - b) / (a + b);
            };
            const std::complex<double> across =
                std::exp(std::complex<double>(0.0, 4.0 * std::numbers::pi * 0.2) * q[1]);
            const std::complex<double> expected =
                (r(q[0], q[1]) + r(q[1], q[2]) * across) / (1.0 + r(q[0], q[1]) * r(q[1], q[2]) * across);
            EXPECT_NEAR(std::abs(found.r_s - expected), 0.0, 1e-13);
            EXPECT_EQ(coating_transmittance(metal, 1.0, 1.5, std::cos(angle), true) < 1e-100, true);
        }
    }
}

// A mirror of 2000 quarter waves: the fields grow by (2.3 / 1.4)^2000, which no double holds, nor a float
// (2.3/1.4)^200.
TEST(Coating, ManyLayersStayFinite) {
    TraceCoating<double> mirror;
    TraceCoating<float> in_float;
    for (int i = 0; i < 1000; ++i) {
        mirror.layers.push_back({2.3, 0.25 / 2.3});
        mirror.layers.push_back({1.4, 0.25 / 1.4});
        in_float.layers.push_back({2.3F, 0.25F / 2.3F});
        in_float.layers.push_back({1.4F, 0.25F / 1.4F});
    }
    for (const double angle : kAngles) {
        const CoatedPowers<double> powers = coating_powers(mirror, 1.0, 1.5, std::cos(angle), true).unpolarised();
        EXPECT_NEAR(powers.reflected + powers.transmitted, 1.0, 1e-12);
        const CoatedPowers<float> rough =
            coating_powers(in_float, 1.0F, 1.5F, static_cast<float>(std::cos(angle)), true).unpolarised();
        EXPECT_NEAR(rough.reflected + rough.transmitted, 1.0F, 1e-3F);
    }
    EXPECT_NEAR(coating_reflectance(mirror, 1.0, 1.5, 1.0, true), 1.0, 1e-12);
    EXPECT_EQ(coating_transmittance(mirror, 1.0, 1.5, 1.0, true), 0.0);
}

// A layer exactly at its own critical angle, where its two waves are one: the limit from either side.
TEST(Coating, AtALayersCriticalAngle) {
    const double cosine = std::sqrt(1.0 - 1.2 * 1.2 / (1.6 * 1.6));
    const TraceCoating<double> gap{.layers = {{2.0, 0.1}, {1.2, 0.7}, {2.0, 0.1}}};
    const CoatedPowers<double> at = coating_powers(gap, 1.6, 1.6, cosine, true).s;
    EXPECT_NEAR(at.absorbed(), 0.0, 1e-14);
    for (const double step : {-1e-9, 1e-9}) {
        EXPECT_NEAR(coating_powers(gap, 1.6, 1.6, cosine + step, true).s.reflected, at.reflected, 1e-6);
    }
    const TraceCoating<double> exact{.layers = {{1.6, 0.7}}};
    EXPECT_NEAR(coating_powers(exact, 1.6, 1.6, 1e-12, true).s.transmitted, 1.0, 1e-12);
}

/// The same layer for all lanes of a packet.
template <class Numbers>
ClearLayer<Numbers> layer_for_all(const TraceLayer<double>& of_stack) {
    const ClearLayer<double> layer = clear_layer(of_stack);
    return {.index = Numbers(layer.index),
            .phase_by_q = Numbers(layer.phase_by_q),
            .squared = Numbers(layer.squared),
            .per_squared = Numbers(layer.per_squared)};
}

// Packets have a single ray's bits where they say that they know; where they do not, a wave fades in a layer, is
// reflected totally, or a layer is no layer at all.
TEST(Coating, OfPacketsIsThatOfEachRay) {
    using Numbers = Pack<double, AbiOf<SimdLevel::baseline, double>>;
    std::mt19937 random(3);
    int known = 0;
    int unknown = 0;
    for (int i = 0; i < 20000; ++i) {
        const TraceCoating<double> stack = random_stack(random, 6, false);
        Incidence of = random_incidence(random);
        std::array<double, Numbers::kLanes> cosines{};
        Numbers cosine;
        for (int lane = 0; lane < Numbers::kLanes; ++lane) {
            cosines[static_cast<std::size_t>(lane)] = random_incidence(random).cosine;
            cosine.set(lane, cosines[static_cast<std::size_t>(lane)]);
        }
        const int count = static_cast<int>(stack.layers.size());
        const double near = of.from_scene_side ? of.n1 : of.n2;
        const double far = of.from_scene_side ? of.n2 : of.n1;
        const auto found = clear_coating_fields(
            count,
            [&](int layer) {
                return layer_for_all<Numbers>(
                    stack.layers[static_cast<std::size_t>(of.from_scene_side ? count - 1 - layer : layer)]);
            },
            CoatedMedia<Numbers>{.near = Numbers(near),
                                 .far = Numbers(far),
                                 .per_squared_near = Numbers(1.0 / (near * near)),
                                 .per_squared_far = Numbers(1.0 / (far * far))},
            cosine);
        for (int lane = 0; lane < Numbers::kLanes; ++lane) {
            of.cosine = cosines[static_cast<std::size_t>(lane)];
            if (!found.holds[lane]) {
                ++unknown;
                const double sine = near * std::sqrt(1.0 - of.cosine * of.cosine);
                const bool passes = std::ranges::all_of(
                    stack.layers, [&](const auto& layer) { return layer.index > sine * (1.0 + 1e-12); });
                EXPECT_FALSE(passes && far > sine * (1.0 + 1e-12));
                continue;
            }
            ++known;
            const PolarisedPowers<double> alone = coating_powers(stack, of.n1, of.n2, of.cosine, of.from_scene_side);
            EXPECT_EQ(found.fields.s.powers().transmitted[lane], alone.s.transmitted);
            EXPECT_EQ(found.fields.s.powers().reflected[lane], alone.s.reflected);
            EXPECT_EQ(found.fields.p.powers().transmitted[lane], alone.p.transmitted);
            EXPECT_EQ(found.fields.p.powers().reflected[lane], alone.p.reflected);
            EXPECT_EQ(found.fields.transmittance()[lane],
                      coating_transmittance(stack, of.n1, of.n2, of.cosine, of.from_scene_side));
            EXPECT_EQ(found.fields.reflectance()[lane],
                      coating_reflectance(stack, of.n1, of.n2, of.cosine, of.from_scene_side));
        }
    }
    EXPECT_GT(known, 5000);
    EXPECT_GT(unknown, 5000);
}

// With one division they are what both polarisations' powers say, but for rounding: six roundings of one number more
// than they have, of terms that are all positive. In float, too, through a mirror's many layers: of its fields the
// fourth powers are no floats.
TEST(Coating, UnpolarisedPowersAreTheMeanOfBoth) {
    const auto expect_mean = []<class T>(const TraceCoating<T>& coating, T n1, T n2, T cosine, bool from_scene_side) {
        const CoatedPowers<T> mean = coating_powers(coating, n1, n2, cosine, from_scene_side).unpolarised();
        const T rounding = T(8) * std::numeric_limits<T>::epsilon();
        EXPECT_NEAR(coating_reflectance(coating, n1, n2, cosine, from_scene_side), mean.reflected,
                    rounding * mean.reflected);
        EXPECT_NEAR(coating_transmittance(coating, n1, n2, cosine, from_scene_side), mean.transmitted,
                    rounding * mean.transmitted);
    };
    std::mt19937 random(5);
    for (int i = 0; i < 5000; ++i) {
        const Incidence at = random_incidence(random);
        expect_mean(random_stack(random, 6, true), at.n1, at.n2, at.cosine, at.from_scene_side);
    }
    TraceCoating<float> mirror;
    for (int i = 0; i < 120; ++i) {
        mirror.layers.push_back({i % 2 == 0 ? 1.38F : 2.3F, i % 2 == 0 ? 0.25F / 1.38F : 0.25F / 2.3F});
        expect_mean(mirror, 1.0F, 1.5F, 1.0F, true);
    }
    EXPECT_NEAR(coating_reflectance(mirror, 1.0F, 1.5F, 1.0F, true), 1.0F, 1e-5F);
    EXPECT_LT(coating_transmittance(mirror, 1.0F, 1.5F, 1.0F, true), 1e-9F);
}

// A stated reflectance is that at every angle; the light that the medium behind reflects totally is all reflected.
TEST(Coating, StatedReflectance) {
    const TraceCoating<double> stated{.layers = {}, .reflectance = 0.01};
    EXPECT_EQ(coating_reflectance(stated, 1.0, 1.5, 0.6, true), 0.01);
    EXPECT_EQ(coating_transmittance(stated, 1.0, 1.5, 0.6, true), 0.99);
    EXPECT_EQ(coating_reflectance(stated, 1.0, 1.5, 0.6, false), 1.0);
    EXPECT_EQ(coating_transmittance(stated, 1.0, 1.5, 0.6, false), 0.0);
    const CoatedAmplitudes<double> amplitudes = coating_amplitudes(stated, 1.0, 1.5, 0.6, true);
    EXPECT_NEAR(std::norm(amplitudes.r_p), 0.01, 1e-16);
    EXPECT_LT(amplitudes.r_s.real(), 0.0);  // as the bare surface's
    const double cos2 = std::sqrt(1.0 - 0.64 / 2.25);
    EXPECT_NEAR(std::norm(amplitudes.t_s) * 1.5 * cos2 / 0.6, 0.99, 1e-15);
}

// The same numbers in each number type of the tracer, to its precision.
TEST(Coating, InEveryNumberType) {
    const auto reflectance = []<class T>(T) {
        const TraceCoating<T> stack{
            .layers = {{T(1.5), T(0.25)}, {T(2.25), T(0.125), T(0.0625)}, {T(0.5), T(0.03125), T(2)}}};
        return coating_reflectance(stack, T(1), T(1.5), T(0.75), true);
    };
    const Multiprecision exact = reflectance(Multiprecision());
    EXPECT_NEAR(reflectance(0.0F), static_cast<float>(exact), 1e-6F);
    EXPECT_NEAR(reflectance(0.0), static_cast<double>(exact), 1e-15);
    EXPECT_NEAR(static_cast<double>(reflectance(0.0L) - static_cast<long double>(exact)), 0.0, 1e-18);
}

}  // namespace lensproof::optics::coating_test
