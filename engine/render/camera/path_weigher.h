// engine/render/camera/path_weigher.h — weights of paths whose wavelengths end at points of their own on the film.
#pragma once
#include <algorithm>
#include <cstddef>

#include "engine/render/camera/camera_paths.h"
#include "engine/spectral/spectral_sample.h"

namespace lensproof::render {

/// Weighs paths by the balance heuristic (BasicSharedRays), some dozen at a time.
class PathWeigher {
  public:
    /// `grid`, `sensor` and `is_box` as BasicSharedRays has them. `has_pdfs`: of the others; else each that arrives has
    /// its hero's.
    PathWeigher(const spectral::SpectralGrid& grid, const Sensor& sensor, bool is_box, bool has_pdfs,
                const PathKernels& kernels);

    /// `meet(first, chunk)` writes where the others end of the chunk's paths, which begin with `first`.
    template <class Meet>
    void weigh(CameraPathBuffer& paths, const Meet& meet) {
        paths.weights.resize(static_cast<std::size_t>(paths.size));
        paths.pdf.resize(chunk_.has_pdfs ? paths.weights.size() : 0);
        for (int first = 0; first < paths.size; first += kSharedChunk) {
            chunk_.size = std::min(kSharedChunk, paths.size - first);
            const auto at = static_cast<std::size_t>(first);
            take_heroes(paths, at);
            meet(at, chunk_);
            kernels_->trace_shared(sensor_, chunk_);
            give_weights(paths, at);
        }
    }

  private:
    void take_heroes(const CameraPathBuffer& paths, std::size_t first);
    void give_weights(CameraPathBuffer& paths, std::size_t first) const;

    spectral::SpectralGrid grid_;
    Sensor sensor_;
    bool is_box_;
    const PathKernels* kernels_;
    SharedPaths chunk_{};
};

}  // namespace lensproof::render
