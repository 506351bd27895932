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
    PathColumn<double> weight;      // that · the filter's weight · the lens's transmittance, sr
    int size = 0;
};

/// What samples are drawn from.
struct PathSampling {
    Sensor sensor;
    std::uint64_t seed = 0;
    int wavelengths = 1;
};

/// Samples of consecutive pixels, or of a rectangle of them: of each pixel the same.
struct CameraPathRange {
    std::uint32_t first_pixel = 0;
    std::uint32_t pixels = 0;  // in a row
    std::uint32_t first_sample = 0;
    std::uint32_t samples = 0;
    std::uint32_t rows = 1;
    std::uint32_t beside_row = 0;  // pixels between the end of a row and the begin of the next

    [[nodiscard]] constexpr std::uint64_t size() const { return std::uint64_t{pixels} * rows * samples; }

    /// Which the i-th is.
    struct Place {
        std::uint32_t pixel = 0;
        std::uint32_t sample = 0;  // counted from `first_sample`
        std::uint32_t row = 0;
    };
    [[nodiscard]] constexpr Place place(std::uint64_t i) const {
        const auto number = static_cast<std::uint32_t>(i / samples);
        const std::uint32_t row = number / pixels;
        return {.pixel = first_pixel + number + row * beside_row,
                .sample = static_cast<std::uint32_t>(i - std::uint64_t{number} * samples),
                .row = row};
    }
    /// The one after it.
    [[nodiscard]] constexpr Place after(Place place) const {
        if (++place.sample == samples) {
            place.sample = 0;
            ++place.pixel;
            if (place.pixel - first_pixel - place.row * (pixels + beside_row) == pixels) {
                ++place.row;
                place.pixel += beside_row;
            }
        }
        return place;
    }
};

/// The next samples to draw: `samples` of each pixel from `first_sample` on.
struct PathCursor {
    std::uint32_t pixel = 0;
    std::uint32_t sample = 0;  // counted from `first_sample`
    std::uint32_t first_sample = 0;
    std::uint32_t samples = 0;
    std::uint32_t row_end = 0;  // behind the last pixel of the row that this one is in
    std::uint32_t row_pixels = 0;
    std::uint32_t beside_row = 0;  // pixels from a row's end to the next one's begin
};

}  // namespace lensproof::render
