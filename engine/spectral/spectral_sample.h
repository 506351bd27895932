// engine/spectral/spectral_sample.h — the wavelengths that a light path carries, and numbers for each of them.
//
// A render samples the midpoints of N equal strata, its grid; everything spectral in a scene is tabulated on it once. A
// path carries four of them, N/4 strata apart, the first of which, its hero, decides wherever one wavelength must
// (A. Wilkie, S. Nawaz, M. Droske, A. Weidlich, J. Hanika, "Hero Wavelength Spectral Sampling", EGSR 2014).
#pragma once
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/spectral/spectrum.h"
#include "engine/spectral/wavelengths.h"

namespace lensproof::spectral {

inline constexpr int kWavelengthsPerPath = 4;

/// A path's wavelengths, as strata of the grid; [0] is the hero.
struct PathWavelengths {
    std::array<std::uint16_t, kWavelengthsPerPath> index{};
    friend bool operator==(const PathWavelengths&, const PathWavelengths&) = default;
};

/// One number for each of a path's wavelengths, in its order. Operators work wavelength by wavelength.
struct alignas(16) SpectralSample {
    std::array<float, kWavelengthsPerPath> value{};

    constexpr SpectralSample() = default;
    /// The same for each.
    constexpr explicit SpectralSample(float same) : value{same, same, same, same} {}
    constexpr explicit SpectralSample(const std::array<float, kWavelengthsPerPath>& values) : value(values) {}

    constexpr float operator[](std::size_t i) const { return value[i]; }
    constexpr float& operator[](std::size_t i) { return value[i]; }
    friend bool operator==(const SpectralSample&, const SpectralSample&) = default;

    constexpr SpectralSample& operator+=(const SpectralSample& b);
    constexpr SpectralSample& operator-=(const SpectralSample& b);
    constexpr SpectralSample& operator*=(const SpectralSample& b);
    constexpr SpectralSample& operator/=(const SpectralSample& b);
    constexpr SpectralSample& operator*=(float scale);
};

/// `function` of each wavelength's numbers.
template <class Function, class... Samples>
constexpr SpectralSample for_each_wavelength(const Function& function, const Samples&... samples) {
    SpectralSample result;
    for (std::size_t i = 0; i < kWavelengthsPerPath; ++i) {
        result.value[i] = function(samples.value[i]...);
    }
    return result;
}

constexpr SpectralSample operator+(const SpectralSample& a, const SpectralSample& b) {
    return for_each_wavelength([](float x, float y) { return x + y; }, a, b);
}
constexpr SpectralSample operator-(const SpectralSample& a, const SpectralSample& b) {
    return for_each_wavelength([](float x, float y) { return x - y; }, a, b);
}
constexpr SpectralSample operator*(const SpectralSample& a, const SpectralSample& b) {
    return for_each_wavelength([](float x, float y) { return x * y; }, a, b);
}
constexpr SpectralSample operator/(const SpectralSample& a, const SpectralSample& b) {
    return for_each_wavelength([](float x, float y) { return x / y; }, a, b);
}
constexpr SpectralSample operator*(float scale, const SpectralSample& a) {
    return for_each_wavelength([scale](float x) { return scale * x; }, a);
}

constexpr SpectralSample& SpectralSample::operator+=(const SpectralSample& b) {
    return *this = *this + b;
}
constexpr SpectralSample& SpectralSample::operator-=(const SpectralSample& b) {
    return *this = *this - b;
}
constexpr SpectralSample& SpectralSample::operator*=(const SpectralSample& b) {
    return *this = *this * b;
}
constexpr SpectralSample& SpectralSample::operator/=(const SpectralSample& b) {
    return *this = *this / b;
}
constexpr SpectralSample& SpectralSample::operator*=(float scale) {
    return *this = scale * *this;
}

constexpr float max_value(const SpectralSample& a) {
    return std::max(std::max(a.value[0], a.value[1]), std::max(a.value[2], a.value[3]));
}
/// Of four equal numbers it is that number to the last bit, as for every sum of two equal floats.
constexpr float mean(const SpectralSample& a) {
    return 0.25F * ((a.value[0] + a.value[1]) + (a.value[2] + a.value[3]));
}
constexpr bool is_black(const SpectralSample& a) {
    return a.value[0] == 0.0F && a.value[1] == 0.0F && a.value[2] == 0.0F && a.value[3] == 0.0F;
}
/// The hero's number, and 0 for the others: for light whose path the hero alone can take.
constexpr SpectralSample hero_alone(const SpectralSample& a) {
    return SpectralSample({a.value[0], 0.0F, 0.0F, 0.0F});
}

/// The strata of a render; `strata.count` is a multiple of kWavelengthsPerPath.
struct SpectralGrid {
    WavelengthStrata strata;

    [[nodiscard]] int size() const { return strata.count; }
    /// The four wavelengths of a path whose hero is stratum `hero`, in [0, size()). As the hero runs through all
    /// strata, so does each of the others.
    [[nodiscard]] constexpr PathWavelengths path(int hero) const {
        PathWavelengths path;
        for (int i = 0; i < kWavelengthsPerPath; ++i) {
            const int unwrapped = hero + i * (strata.count / kWavelengthsPerPath);
            path.index[static_cast<std::size_t>(i)] =
                static_cast<std::uint16_t>(unwrapped < strata.count ? unwrapped : unwrapped - strata.count);
        }
        return path;
    }
    /// The midpoints, in the path's order.
    [[nodiscard]] std::array<double, kWavelengthsPerPath> wavelengths_nm(const PathWavelengths& path) const;
};

/// The grid, checked: throws InputError unless 0 < min_nm < max_nm are finite and `count` is a positive multiple of
/// kWavelengthsPerPath and at most 65536.
SpectralGrid spectral_grid(double min_nm, double max_nm, int count);

/// A spectrum tabulated on a grid.
struct GridSpectrum {
    std::vector<float> value;  // one for each stratum

    SpectralSample operator()(const PathWavelengths& path) const {
        return SpectralSample({value[path.index[0]], value[path.index[1]], value[path.index[2]], value[path.index[3]]});
    }
};

/// The mean over each stratum, exactly; zero beyond the spectrum's ends. For light: lines keep their power.
GridSpectrum stratum_means(const Spectrum& spectrum, const SpectralGrid& grid);

/// The value at each midpoint; beyond the spectrum's ends the last measured value, as CIE 167:2005, §9, advises. For
/// reflectances and indices. Zero everywhere for a spectrum without samples.
GridSpectrum at_midpoints(const Spectrum& spectrum, const SpectralGrid& grid);

/// `function(wavelength_nm)` at each midpoint.
template <class Function>
GridSpectrum tabulated(const SpectralGrid& grid, const Function& function) {
    GridSpectrum table;
    table.value.reserve(static_cast<std::size_t>(grid.size()));
    for (int i = 0; i < grid.size(); ++i) {
        table.value.push_back(static_cast<float>(function(grid.strata.midpoint(i))));
    }
    return table;
}

/// The same number in each stratum.
GridSpectrum constant_spectrum(double value, const SpectralGrid& grid);

}  // namespace lensproof::spectral
