// experiments/studies/edge_diffraction/measure_edges.h — what the edges of a stop diffract, by rays and by waves.
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "engine/base/json_archive.h"

namespace lensproof::studies {

/// A star on the axis of a lens that is stopped down, at 550 nm.
struct EdgeSetting {
    std::string lens;
    double f_number = 8.0;
    int blades = 0;          // 0: a circle
    double curvature = 0.0;  // of the blades' edges: 0 straight, 1 round
    int paths = 300'000;     // of light
    bool has_maps = true;    // for drawings
};

/// The unit of length on the film: λN.
double airy_mm(const EdgeSetting& setting);

/// The profile's octaves begin here, in λN from the image, half an octave apart. Each is weighed by sin² over it, which
/// averages what oscillates with a period of about a λN.
inline constexpr std::array kOctaves = {5.0, 7.0, 10.0, 14.0, 20.0, 28.0, 40.0, 50.0};
inline constexpr double kOutermost = 100.0;  // λN

/// Irradiances over that of the light, all azimuths together.
struct EdgeProfile {
    std::vector<double> octaves;  // means
    std::vector<Vec2d> rings;     // (λN, mean) of narrow rings, outwards
    double energy = 0.0;  // the sum from 5 to 100 λN, in (λN)²; its beginning is the mean of those from 5 to 7,
                          // since a sharp cut swings with the rings
    double near_streaks = 0.0;  // of the light beyond 20 λN, what lies within a λN of a streak's middle: of straight
                                // blades, else 0

    /// d log E / d log r, by least squares over the octaves.
    [[nodiscard]] double slope() const;
};

/// Where one streak stands.
struct Streak {
    double light = 0.0;     // over that of the strongest
    double turn_deg = 0.0;  // its mean azimuth, from the normal of the edge that makes it
};

/// What a number of light paths makes.
struct EdgeRays {
    EdgeProfile profile;
    std::vector<Streak> streaks;  // of straight blades: two each where their number is odd, else one
};

inline constexpr int kEdgeBatches = 8;  // of light paths, independent of each other

/// A square about the image, row by row from its low y: log10 of the irradiance over the light's.
struct EdgeMap {
    int side = 0;  // pixels
    std::vector<float> values;
};
inline constexpr double kMapRadius = 50.0;  // λN

struct EdgeDiffraction {
    EdgeRays rays;
    std::vector<EdgeRays> batches;  // which `rays` is of all together: how far they differ is its error
    EdgeProfile wave;
    EdgeMap ray_map;  // both empty where they are not asked for
    EdgeMap wave_map;
};

void fields(JsonArchive& json, EdgeDiffraction& found);

/// The film that the pass "diffracted" makes, and analysis::EdgeWave. Throws InputError for a lens that cannot be set
/// so or whose stop has no edges.
EdgeDiffraction measure_edges(const EdgeSetting& setting, std::uint64_t seed);

}  // namespace lensproof::studies
