// calibration/sharpness/star_modulation.h — how strongly a Siemens star's pattern shows, by frequency.
#pragma once
#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

namespace lensproof::calibration {

inline constexpr int kStarWedges = 12;       // of a segment, for errors
inline constexpr double kStarHighest = 1.0;  // cycles per pixel

/// A pixel of one segment of a star.
struct StarPixel {
    double turn = 0.0;  // across the segment, from -1/2 to 1/2
    double radius_px = 0.0;
    double phase = 0.0;
    double cycles_per_px = 0.0;
    double light = 0.0;

    [[nodiscard]] std::size_t wedge() const {
        return static_cast<std::size_t>(std::clamp(static_cast<int>((turn + 0.5) * kStarWedges), 0, kStarWedges - 1));
    }
};

using StarWedges = std::array<double, kStarWedges>;

/// A number, and what the residuals of each wedge add to it.
struct StarEstimate {
    double value = 0.0;
    StarWedges of_wedge{};
};

/// A bin of frequencies.
struct StarModulation {
    double cycles_per_px = 0.0;
    double radius_px = 0.0;
    StarEstimate level;      // the mean light
    StarEstimate amplitude;  // of the fundamental
};

/// The sum of the squares.
double variance(const StarWedges& wedges);

void add(StarWedges& sum, double weight, const StarWedges& other);

/// Bins of frequencies, ascending, by the steps 1, 2 and 4 of `measure_star`. Sorts the pixels.
std::vector<StarModulation> star_modulations(std::vector<StarPixel>& pixels);

}  // namespace lensproof::calibration
