// engine/render/camera/camera_paths.h — camera paths, drawn ahead of the integrator that needs them: a buffer at a
// time.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "engine/base/simd_level.h"
#include "engine/optics/packet/ray_batch.h"
#include "engine/render/camera/film_importance.h"
#include "engine/render/camera/packet/path_kernels.h"
#include "engine/render/sampling/pixel_filter.h"
#include "engine/spectral/spectral_sample.h"

namespace lensproof::render {

/// What paths carry besides their hero: each costs time.
enum class PathCarry {
    hero,                  // nothing
    wavelengths,           // what the path counts at each of its wavelengths
    wavelengths_and_pdfs,  // that, and with which pdf it was drawn
};

/// Camera paths that left the lens, a column a quantity: what an integrator goes through instead of calling the lens
/// for each of its paths. Those that the lens stopped are not among them; they add nothing to any sum.
///
/// The estimator of the measurement equation at film point x (Kolb et al. 1995, eq. 4), E = ∫ L τ cos⁴θ / Z² dA over
/// the pupil, is the mean of L · weight over all samples of a pixel, stopped ones as zeros: L is the radiance that
/// comes towards the lens along the exit ray at the path's wavelength, W·m⁻²·sr⁻¹·nm⁻¹; E then has W·m⁻²·nm⁻¹.
struct CameraPathBuffer {
    static constexpr int kUsualCapacity = 4096;

    explicit CameraPathBuffer(int capacity = kUsualCapacity);

    optics::PacketColumn<std::uint32_t> pixel;       // row by row from the top left
    optics::PacketColumn<std::uint32_t> sample;      // of the pixel
    optics::PacketColumn<std::uint16_t> wavelength;  // which of the camera's: the hero's
    optics::PacketColumn<double> film_x;             // mm, in lens space; not set by a device for PathCarry::hero
    optics::PacketColumn<double> film_y;
    optics::PacketColumn<double> weight;       // τ cos⁴θ / Z² / the pdf of the pupil point · the filter's, sr
    optics::PacketColumn<double> etendue;      // of paths out of a LensPaths: cos⁴θ / Z² / that pdf, sr; as film_x
    optics::RayBatch<double>::Vectors origin;  // on the first surface, mm, in lens space
    optics::RayBatch<double>::Vectors direction;  // away from the lens, of unit length
    /// Of paths that carry them: what each counts at its wavelengths, sr, the mean over which is the sample; and the
    /// pdf that it was drawn with, per etendue times a pixel's area.
    std::vector<std::array<float, spectral::kWavelengthsPerPath>> weights;
    std::vector<PathPdf> pdf;
    int capacity = 0;  // columns are longer by what fills the last packet
    int size = 0;      // paths in use

    [[nodiscard]] Ray<double> ray(std::size_t i) const {
        return {{origin.x[i], origin.y[i], origin.z[i]}, {direction.x[i], direction.y[i], direction.z[i]}};
    }

    /// What a path counts that its hero takes alone, sr.
    [[nodiscard]] float hero_weight(std::size_t i) const {
        return static_cast<float>(spectral::kWavelengthsPerPath * weight[i]);
    }
    /// Weighs all paths so.
    void leave_heroes_alone();

    /// Adds `count` paths: `copy(from, to)` writes what a column of these has of them.
    template <class T, class Copy>
    void append(const PathStarts& starts, const optics::RayBatch<T>& rays, int count, const Copy& copy) {
        const auto add = [&](const auto& from, auto& to) { copy(from.data(), to.data() + size); };
        add(starts.pixel, pixel);
        add(starts.sample, sample);
        add(starts.wavelength, wavelength);
        add(starts.film_x, film_x);
        add(starts.film_y, film_y);
        add(starts.weight, weight);
        add(starts.etendue, etendue);
        add(rays.origin.x, origin.x);
        add(rays.origin.y, origin.y);
        add(rays.origin.z, origin.z);
        add(rays.direction.x, direction.x);
        add(rays.direction.y, direction.y);
        add(rays.direction.z, direction.z);
        size += count;
    }

    /// What a path counts, times a factor.
    void scale(std::size_t i, double factor) {
        weight[i] *= factor;
        for (std::size_t m = 0; m < spectral::kWavelengthsPerPath && !weights.empty(); ++m) {
            weights[i][m] *= static_cast<float>(factor);
        }
    }
};

/// The centre of the pixel that a path belongs to. `is_box`: pixels are the filter; else that in which its film point
/// lies.
Vec2d path_pixel(const CameraPathBuffer& paths, std::size_t path, const Sensor& sensor, bool is_box);

/// Where the samples of a render lie on the film.
struct FilmSampling {
    Sensor sensor;
    std::uint64_t seed = 0;
    PixelFilter filter;  // that film points are drawn from, around their pixel
};

/// The samples of a range, pixel after pixel, sample after sample: film points, wavelengths, numbers for the pupil.
/// What a sample is depends on seed, pixel and sample alone: not on the range, the buffer's capacity or the machine.
class FilmSamples {
  public:
    /// `level`: of the packets, as `trace_batch` has it.
    FilmSamples(FilmSampling film, int wavelengths, std::optional<SimdLevel> level = {});

    /// Begins a range, at its `skipped`-th sample. What was left of the one before is dropped.
    void start(const CameraPathRange& range, std::uint64_t skipped = 0);

    /// Replaces what is in the buffer by the next paths, as many as fit: at least one, but for the end of the range.
    /// False when none is left. `append(starts)` adds those that begin with these samples.
    template <class Append>
    bool fill(CameraPathBuffer& buffer, const Append& append) {
        buffer.size = 0;
        while (left_ > 0) {
            const int room = buffer.capacity - buffer.size;
            if (room < optics::kMostLanes && buffer.size > 0) {
                break;
            }
            draw(room);
            append(starts_);
        }
        return buffer.size > 0;
    }

  private:
    /// The next ones: as many as surely fit, in whole packets while there are such.
    void draw(int room);
    /// Film points are even over their pixel so far; where in it makes the number that the filter's draw takes.
    void draw_from_filter();

    PathSampling sampling_;
    PixelFilter filter_;
    const PathKernels* kernels_;
    PathCursor cursor_;
    std::uint64_t left_ = 0;  // samples of the range
    PathStarts starts_{};
};

}  // namespace lensproof::render
