// engine/render/camera/shared_rays.h — what a path outside the lens counts at each of its wavelengths.
#pragma once
#include <cstdint>
#include <optional>
#include <span>

#include "engine/optics/packet/trace_batch.h"
#include "engine/pupil/pupil_slices.h"
#include "engine/render/camera/path_weigher.h"

namespace lensproof::render {

/// Where rays (lens space) meet film and pupil, as `trace_batch` left them behind a lens, kSharedChunk at the most; and
/// what of their light arrives.
template <class T>
void meet_film(double film_z, double pupil_z, const PathKernels& kernels, const optics::RayBatch<T>& behind,
               FilmMeetings& meetings);

/// With which pdf camera paths of these wavelengths, one a meeting, draw those points of the pupil.
void find_pupil_pdfs(const pupil::PupilSlices& pupil, std::span<const std::uint16_t> wavelengths,
                     const PathKernels& kernels, FilmMeetings& meetings);

/// Camera paths are drawn for their hero; outside the lens the ray serves the other wavelengths too, each of which
/// reaches it by its own path through the glass, from its own point on the film. Of the four techniques "draw the ray
/// as wavelength m's hero, in this pixel" each could have drawn the ray with a pdf p_m of its own, 0 where its film
/// point lies outside the pixel. Weighed by the balance heuristic (Veach & Guibas 1995; Wilkie et al. 2014, eq. 8),
/// wavelength j counts
///
///     w_j = τ_j / (¼ Σ_m p_m)   if its film point lies in the pixel, else 0;
///
/// pdfs are per etendue, which is the same on both sides of the lens. Nothing crosses a pixel's border: what a
/// wavelength brings elsewhere, that pixel's own paths bring. A lens whose colours part by more than a pixel leaves the
/// hero alone, with w = 4 τ / p.
///
/// Where nobody asks for pdfs, those of the others are not looked up: the techniques whose ray arrives in the pixel get
/// equal parts, as if each p_m were the hero's p. Any parts whose sum is one for every ray leave the mean as it is, if
/// whoever gets a part draws the ray now and then: a lens's map draws from the whole rear element, too, wherever it has
/// light. Where the ray arrives the pdfs differ as the areas of the pupil do, by little: the variance of pictures stays
/// within a percent, and a tenth of a path's time is saved.
///
/// The hero's own p and τ are those that its path was made with; the other wavelengths' rays are traced.
///
/// T: double or float, in which they are. Of float the double lens may judge: it is asked again for the rays that end
/// nearer to their pixel's border than float is allowed to cost (optics::float_error_bound_um), and so says where all
/// of them end; float says how much of them arrives, and whether a ray that grazes a rim does.
template <class T>
class BasicSharedRays {
  public:
    /// Lens and pupil outlive it. `lens` at the strata of `grid`. `is_box`: pixels are the filter, as w needs it; else
    /// the pixel of a path is the one that its film point lies in, and w is for its pdfs alone. `level`: that of
    /// `trace_batch`. `at_borders`: judges, if there is one; outlives it, too.
    BasicSharedRays(const spectral::SpectralGrid& grid, const optics::SpectralLens<T>& lens,
                    const pupil::PupilSlices& pupil, const Sensor& sensor, bool is_box, PathCarry carry,
                    std::optional<SimdLevel> level = {}, const optics::SpectralLens<double>* at_borders = nullptr);

    /// Of paths out of a BasicLensPaths. Writes w of its four wavelengths to every path of the buffer and, for
    /// PathCarry::wavelengths_and_pdfs, the pdfs that it was drawn with: ¼ Σ_m p_m, and p of the hero.
    void weigh(CameraPathBuffer& paths);

  private:
    /// Each of the others' rays, and where it ends.
    void trace(const CameraPathBuffer& paths, std::size_t first, SharedPaths& chunk);
    void trace_again_at_borders(const CameraPathBuffer& paths, std::size_t first, SharedPaths& chunk);

    PathWeigher weigher_;
    const optics::SpectralLens<T>* lens_;
    const pupil::PupilSlices* pupil_;
    Sensor sensor_;
    const PathKernels* kernels_;
    optics::BatchSettings tracing_;
    optics::RayBatch<T> turned_;  // the paths' rays on their way in
    optics::RayBatch<T> rays_;    // a wavelength's

    /// What judges at borders.
    struct Judge {
        const optics::SpectralLens<double>* lens;
        double within_mm;
        optics::RayBatch<double> rays;
        FilmMeetings meetings;
    };
    std::optional<Judge> judge_;
};
using SharedRays = BasicSharedRays<double>;

extern template class BasicSharedRays<float>;
extern template class BasicSharedRays<double>;

}  // namespace lensproof::render
