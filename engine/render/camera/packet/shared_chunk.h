// engine/render/camera/packet/shared_chunk.h — some dozen camera paths whose rays outside their wavelengths share.
#pragma once
#include <array>
#include <cstdint>

#include "engine/optics/packet/ray_batch.h"
#include "engine/spectral/spectral_sample.h"

namespace lensproof::render {

/// How many: as many as stay in the first-level cache with their rays.
inline constexpr int kSharedChunk = 64;

template <class Number>
using SharedColumn = std::array<Number, kSharedChunk>;

/// Where rays behind the lens meet film and pupil, lens space, mm; a wavelength of each path.
struct alignas(optics::kPacketAlignment) FilmMeetings {
    SharedColumn<double> film_x;
    SharedColumn<double> film_y;
    SharedColumn<double> pupil_x;
    SharedColumn<double> pupil_y;
    SharedColumn<double> per_etendue;    // as FilmCrossing has it
    SharedColumn<double> pupil_pdf;      // of that pupil point for that film point, 1/mm², where it was asked for
    SharedColumn<double> transmittance;  // below 0: the ray does not get there
};

inline constexpr std::size_t kOtherWavelengths = spectral::kWavelengthsPerPath - 1;

/// One of the others' rays: of which path of the chunk, and the how-manieth other wavelength.
struct OtherRay {
    std::uint16_t path;
    std::uint16_t other;
};
using OtherRays = std::array<OtherRay, kOtherWavelengths * kSharedChunk>;

/// The heroes are known from the paths; the others were traced.
struct alignas(optics::kPacketAlignment) SharedPaths {
    SharedColumn<double> centre_x;  // of the path's pixel, px
    SharedColumn<double> centre_y;
    SharedColumn<double> hero_weight;  // as CameraPathBuffer has them
    SharedColumn<double> hero_etendue;
    SharedColumn<std::uint16_t> hero_wavelengths;
    std::array<SharedColumn<std::uint16_t>, kOtherWavelengths> other_wavelengths;
    std::array<FilmMeetings, kOtherWavelengths> others;
    std::array<SharedColumn<float>, spectral::kWavelengthsPerPath> weight;  // as SharedWeights has them
    SharedColumn<double> shared_pdf;
    SharedColumn<double> hero_pdf;
    int size = 0;
    bool has_pdfs = false;  // of the others; else each that arrives has its hero's
};

}  // namespace lensproof::render
