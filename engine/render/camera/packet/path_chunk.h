// engine/render/camera/packet/path_chunk.h — a few hundred camera paths on their way from the film to the lens.
#pragma once
#include <array>
#include <cstdint>

#include "engine/optics/packet/ray_batch.h"
#include "engine/render/film/sensor.h"

namespace lensproof::render {

/// How many: as many as stay in the first-level cache with all their columns.
inline constexpr int kPathChunk = 256;

template <class Number>
using PathColumn = std::array<Number, kPathChunk>;

/// Samples and where they begin and aim at; film and pupil in lens space, mm.
struct alignas(optics::kPacketAlignment) PathStarts {
    PathColumn<std::uint32_t> pixel;
    PathColumn<std::uint32_t> sample;
    PathColumn<double> film_x;
    PathColumn<double> film_y;
    PathColumn<double> filter_weight;  // the pixel filter over the pdf that the film point was drawn with
    PathColumn<double> pupil_u;        // in the unit square
    PathColumn<double> pupil_v;
    PathColumn<double> wavelength_number;  // in the unit interval
    PathColumn<std::uint16_t> wavelength;
    PathColumn<double> pupil_x;
    PathColumn<double> pupil_y;
    PathColumn<double> pupil_area;  // 1 / the pdf that the pupil point was drawn with, mm²; 0: no path
    PathColumn<double> etendue;     // cos⁴θ / Z² · that area, sr
    int size = 0;
};

/// What samples are drawn from.
struct PathSampling {
    Sensor sensor;
    std::uint64_t seed = 0;
    int wavelengths = 1;
};

/// The next samples to draw: `samples` of each pixel from `first_sample` on.
struct PathCursor {
    std::uint32_t pixel = 0;
    std::uint32_t sample = 0;  // counted from `first_sample`
    std::uint32_t first_sample = 0;
    std::uint32_t samples = 0;
};

}  // namespace lensproof::render
