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
struct SpectralSample {
    /// A register: as an array they would come back from functions in two halves, to be put together by way of memory.
    using Numbers [[gnu::vector_size(kWavelengthsPerPath * sizeof(float))]] = float;
    Numbers value{};

    constexpr SpectralSample() = default;
    /// The same for each.
    constexpr explicit SpectralSample(float same) : value{same, same, same, same} {}
    constexpr explicit SpectralSample(const std::array<float, kWavelengthsPerPath>& values)
        : value{values[0], values[1], values[2], values[3]} {}
    constexpr explicit SpectralSample(const Numbers& values) : value(values) {}

    float operator[](std::size_t i) const { return value[i]; }
    friend bool operator==(const SpectralSample& a, const SpectralSample& b) {
        return a[0] == b[0] && a[1] == b[1] && a[2] == b[2] && a[3] == b[3];
    }

    SpectralSample& operator+=(const SpectralSample& b) { return *this = SpectralSample(value + b.value); }
    SpectralSample& operator-=(const SpectralSample& b) { return *this = SpectralSample(value - b.value); }
    SpectralSample& operator*=(const SpectralSample& b) { return *this = SpectralSample(value * b.value); }
    SpectralSample& operator/=(const SpectralSample& b) { return *this = SpectralSample(value / b.value); }
    SpectralSample& operator*=(float scale) { return *this = SpectralSample(scale * value); }
};

inline SpectralSample operator+(SpectralSample a, const SpectralSample& b) {
    return a += b;
}
inline SpectralSample operator-(SpectralSample a, const SpectralSample& b) {
    return a -= b;
}
inline SpectralSample operator*(SpectralSample a, const SpectralSample& b) {
    return a *= b;
}
inline SpectralSample operator/(SpectralSample a, const SpectralSample& b) {
    return a /= b;
}
inline SpectralSample operator*(float scale, SpectralSample a) {
    return a *= scale;
}

/// `function` of each wavelength's numbers.
template <class Function, class... Samples>
SpectralSample for_each_wavelength(const Function& function, const Samples&... samples) {
    return SpectralSample(SpectralSample::Numbers{function(samples[0]...), function(samples[1]...),
                                                  function(samples[2]...), function(samples[3]...)});
}

inline float max_value(const SpectralSample& a) {
    return std::max(std::max(a[0], a[1]), std::max(a[2], a[3]));
}
/// Of four equal numbers it is that number to the last bit, as for every sum of two equal floats.
inline float mean(const SpectralSample& a) {
    return 0.25F * ((a[0] + a[1]) + (a[2] + a[3]));
}
inline bool is_black(const SpectralSample& a) {
    return a[0] == 0.0F && a[1] == 0.0F && a[2] == 0.0F && a[3] == 0.0F;
}
/// The hero's number, and 0 for the others: for light whose path the hero alone can take.
inline SpectralSample hero_alone(const SpectralSample& a) {
    return SpectralSample({a[0], 0.0F, 0.0F, 0.0F});
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
