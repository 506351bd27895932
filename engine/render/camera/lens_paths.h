// engine/render/camera/lens_paths.h — camera paths out of a lens, traced in packets.
#pragma once
#include <cstdint>
#include <optional>

#include "engine/optics/packet/trace_batch.h"
#include "engine/pupil/pupil_slices.h"
#include "engine/render/camera/camera_paths.h"

namespace lensproof::render {

/// Fills buffers with the paths of a range. For one thread; a copy is for another.
class LensPaths {
  public:
    /// `lens` at the wavelengths that samples spread evenly over, `pupil` at those too; both outlive this. `level`:
    /// that of `trace_batch`.
    LensPaths(FilmSampling film, const optics::SpectralLens<double>& lens, const pupil::PupilSlices& pupil,
              std::optional<optics::SimdLevel> level = {});

    /// As `FilmSamples` has them.
    void start(const CameraPathRange& range) { samples_.start(range); }
    bool fill(CameraPathBuffer& buffer);

    /// Paths that were started since the construction, stopped ones included; samples where the film gets no light are
    /// none.
    [[nodiscard]] std::int64_t started() const { return started_; }

  private:
    /// Returns how many samples start a path.
    int draw_pupil_points(PathStarts& starts) const;
    void move_survivors(const PathStarts& starts, CameraPathBuffer& buffer);

    FilmSamples samples_;
    const optics::SpectralLens<double>* lens_;
    const pupil::PupilSlices* pupil_;
    const PathKernels* kernels_;
    optics::BatchSettings tracing_;
    optics::RayBatch<double> rays_;
    std::int64_t started_ = 0;
};

}  // namespace lensproof::render
