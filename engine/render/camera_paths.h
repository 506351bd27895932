// engine/render/camera_paths.h — camera paths, traced through the lens ahead of the pass that needs them.
#pragma once
#include <cstdint>
#include <memory>
#include <optional>

#include "engine/optics/packet/trace_batch.h"
#include "engine/pupil/pupil_slices.h"
#include "engine/render/packet/path_kernels.h"
#include "engine/render/sampling/pixel_filter.h"
#include "engine/render/sampling/sensor.h"

namespace lensproof::render {

/// Camera paths that left the lens, a column a quantity: what a pass goes through instead of calling the lens for each
/// of its paths. Those that the lens stopped are not among them; they add nothing to any sum.
///
/// The estimator of the measurement equation at film point x (Kolb et al. 1995, eq. 4), E = ∫ L τ cos⁴θ / Z² dA over
/// the pupil, is the mean of L · weight over all samples of a pixel, stopped ones as zeros: L is the radiance that
/// comes towards the lens along the exit ray at the path's wavelength, W·m⁻²·sr⁻¹·nm⁻¹; E then has W·m⁻²·nm⁻¹.
template <class T>
struct CameraPathBuffer {
    static constexpr int kUsualCapacity = 4096;

    explicit CameraPathBuffer(int capacity = kUsualCapacity);

    optics::PacketColumn<std::uint32_t> pixel;       // row by row from the top left
    optics::PacketColumn<std::uint32_t> sample;      // of the pixel
    optics::PacketColumn<std::uint16_t> wavelength;  // which of the lens's
    optics::PacketColumn<double> film_x;             // mm, in lens space
    optics::PacketColumn<double> film_y;
    optics::PacketColumn<T> weight;  // τ cos⁴θ / Z² / the density of the pupil point · the filter's, sr
    typename optics::RayBatch<T>::Vectors origin;     // on the first surface, mm, in lens space
    typename optics::RayBatch<T>::Vectors direction;  // away from the lens, of unit length
    int capacity = 0;
    int size = 0;  // paths in use

    [[nodiscard]] Ray<T> ray(int i) const {
        const auto at = static_cast<std::size_t>(i);
        return {{origin.x[at], origin.y[at], origin.z[at]}, {direction.x[at], direction.y[at], direction.z[at]}};
    }
};

/// What camera paths are made of. Held by pointer: it outlives its producers.
template <class T>
struct CameraPathSource {
    Sensor sensor;
    const optics::SpectralLens<T>* lens = nullptr;  // at the wavelengths that samples spread evenly over
    const pupil::PupilSlices* pupil = nullptr;      // at those wavelengths
    std::uint64_t seed = 0;
    PixelFilter filter;  // that film points are drawn from, around their pixel
};

/// Samples of consecutive pixels: of each pixel the same.
struct CameraPathRange {
    std::uint32_t first_pixel = 0;
    std::uint32_t pixels = 0;
    std::uint32_t first_sample = 0;
    std::uint32_t samples = 0;
};

/// Fills buffers with the paths of a range, pixel after pixel, sample after sample. What a path is depends on source,
/// pixel and sample alone: not on the range, the buffer's capacity or the machine. A producer for each thread.
template <class T>
class CameraPathProducer {
  public:
    /// `level`: that of `trace_batch`.
    explicit CameraPathProducer(const CameraPathSource<T>& source, std::optional<optics::SimdLevel> level = {});

    /// Begins a range. What was left of the one before is dropped.
    void start(const CameraPathRange& range);

    /// Replaces what is in the buffer by the next paths, as many as fit: at least one, but for the end of the range.
    /// False when none is left.
    bool fill(CameraPathBuffer<T>& buffer);

    /// Paths that were started since the construction, stopped ones included; samples where the film gets no light are
    /// none.
    [[nodiscard]] std::int64_t started() const { return started_; }

  private:
    /// Returns how many samples start a path.
    int draw_pupil_points();
    /// False where the film gets no light, and nothing was traced.
    bool draw_and_trace(int count);
    void weigh_by_filter();
    void move_survivors(CameraPathBuffer<T>& buffer);

    CameraPathSource<T> source_;
    optics::BatchSettings tracing_;
    const PathKernels<T>* kernels_;
    PathCursor cursor_;
    std::uint32_t end_pixel_ = 0;
    std::unique_ptr<PathStarts> starts_;
    PathColumn<double> filter_weight_{};  // unused for the box
    optics::RayBatch<T> rays_;
    std::int64_t started_ = 0;
};

extern template struct CameraPathBuffer<float>;
extern template struct CameraPathBuffer<double>;
extern template class CameraPathProducer<float>;
extern template class CameraPathProducer<double>;

}  // namespace lensproof::render
