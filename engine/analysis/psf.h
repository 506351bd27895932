// engine/analysis/psf.h — point spread functions by FFT and by direct Huygens sum, and the Strehl ratio.
#pragma once
#include <vector>

#include "engine/analysis/sampled_pupil.h"

namespace lensproof::analysis {

/// The image of a point: irradiance on an even grid in the image plane, for light of total power 1.
struct Psf {
    PupilStatus status = PupilStatus::no_light;  // else the grid is empty or, `aliased`, wrong
    int size = 0;                                // pixels along each side
    double pixel_um = 0.0;
    std::vector<double> irradiance;      // 1/µm²; row-major, y rising by rows, x by columns
    double perfect_peak = 0.0;           // 1/µm²: the peak of the same pupils without aberration
    double strehl = 0.0;                 // the peak, found between the pixels, over `perfect_peak`
    Vec2d peak_um;                       // where it is
    double largest_aberration_um = 0.0;  // of the rays, from the image point
    int needed_size = 0;  // of an FFT with such pixels: the power of two whose window holds the rays; 0: not by FFT

    /// From the image point (PolychromaticField), along x or y, of a column or row.
    [[nodiscard]] double position_um(int index) const {
        const int middle = size / 2;
        return pixel_um * (index - middle);
    }
    [[nodiscard]] double at(int row, int column) const {
        return irradiance[static_cast<std::size_t>(row) * static_cast<std::size_t>(size) +
                          static_cast<std::size_t>(column)];
    }
};

/// How the FFT samples. Its window is size × pixel wide, and repeats itself: the rays must fall into it, or the status
/// is `aliased` (path differences of more than half a wave per sample). A pixel of more than λ / (2 D), D being the
/// beam's width in direction cosines (λ N / 2 at f-number N), shows too little for sums over the picture; from λ / D
/// the beam does not fit into the grid.
struct FftPsfSettings {
    int size = 256;         // a power of two
    double pixel_um = 0.0;  // 0: λ / (2 D) at the wavelength for which that is least
};

/// By FFT of the pupil function at each wavelength. Throws InputError for a size that is no power of two from 8 to 8192
/// or a pixel into whose grid the beam does not fit.
Psf fft_psf(const PolychromaticField& field, const FftPsfSettings& settings = {});

/// How the Huygens sum samples. Nodes must be close enough that path differences, tilt towards the corners of the
/// picture included, change by less than half a wave from one to the next, or the status is `aliased`.
struct HuygensPsfSettings {
    int size = 64;
    double pixel_um = 0.5;
    int azimuths = 96;
    int rings = 32;
};

/// By the direct sum of spherical wavelets from the reference sphere in the exit pupil (Born & Wolf 8.2; from a
/// telecentric pupil, plane waves). With u the unit vector from a ray's point on the sphere to the image point, and
/// curvature c, a wavelet's path to the point ξ beside that is longer by
///     (2 u·ξ + c ξ²) / (1 + √(1 + 2 c u·ξ + c² ξ²)).
/// Shares no grid, no aiming and no transform with `fft_psf`; they agree where the Fresnel number of the exit pupil is
/// large.
Psf huygens_psf(const PolychromaticField& field, const HuygensPsfSettings& settings = {});

}  // namespace lensproof::analysis
