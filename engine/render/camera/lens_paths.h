// engine/render/camera/lens_paths.h — camera paths out of a lens, traced in packets.
#pragma once
#include <cstdint>
#include <optional>

#include "engine/optics/packet/trace_batch.h"
#include "engine/pupil/pupil_slices.h"
#include "engine/render/camera/camera_paths.h"

namespace lensproof::render {

/// Fills buffers with the paths of a range. For one thread; a copy is for another.
///
/// T: double, or float, in which the rays are then traced; all else is double.
template <class T>
class BasicLensPaths {
  public:
    /// `lens` at the wavelengths that samples spread evenly over, `pupil` at those too; both outlive this. `level`:
    /// that of `trace_batch`.
    BasicLensPaths(FilmSampling film, const optics::SpectralLens<T>& lens, const pupil::PupilSlices& pupil,
                   std::optional<SimdLevel> level = {});

    /// As `FilmSamples` has them.
    void start(const CameraPathRange& range, std::uint64_t skipped = 0) { samples_.start(range, skipped); }
    bool fill(CameraPathBuffer& buffer);

    /// Paths that were started since the construction, stopped ones included; samples where the film gets no light are
    /// none.
    [[nodiscard]] std::int64_t started() const { return started_; }

  private:
    /// Returns how many samples start a path.
    int draw_pupil_points(PathStarts& starts) const;
    void trace();
    void move_survivors(PathStarts& starts, CameraPathBuffer& buffer);

    FilmSamples samples_;
    const optics::SpectralLens<T>* lens_;
    const pupil::PupilSlices* pupil_;
    const PathKernels* kernels_;
    optics::BatchSettings tracing_;
    optics::RayBatch<double> aimed_;
    std::optional<optics::RayBatch<T>> narrowed_;  // what is traced, of another T than double
    std::int64_t started_ = 0;
};
using LensPaths = BasicLensPaths<double>;

extern template class BasicLensPaths<float>;
extern template class BasicLensPaths<double>;

}  // namespace lensproof::render
