// engine/analysis/mtf.h — modulation transfer of a field: diffraction-limited, with diffraction, and by rays alone.
#pragma once
#include <complex>
#include <span>
#include <vector>

#include "engine/analysis/sampled_pupil.h"

namespace lensproof::analysis {

/// Modulation against frequency. `tangential`: of lines across the meridional plane, so modulated along y; `sagittal`:
/// along x. In the image plane, cycles per mm.
struct MtfCurve {
    PupilStatus status = PupilStatus::no_light;  // else the values are missing or, `aliased`, wrong
    std::vector<double> frequency;
    std::vector<double> tangential;
    std::vector<double> sagittal;
};

/// Which aberrations count.
enum class MtfKind { diffraction, diffraction_limited };

/// The sampled pupils of a field at all of its wavelengths, `samples` (8 to 4096) cells across the wider side of each
/// beam; 0: 128, or as many up to 1024 as its aberrations need.
std::vector<SampledPupil> sample_pupils(const PolychromaticField& field, int samples = 0);

/// The MTF of sampled pupils, as the normalised autocorrelation of the pupil function (Hopkins 1953; Goodman,
/// Introduction to Fourier Optics, 6.3): a frequency f along y shears it by λ f in direction cosines. Between whole
/// cells of shear the transfer function, freed of the phase of its centroid, is interpolated with cubics. Wavelengths
/// add up with their phases, about the image point, so that lateral colour costs contrast. The real pupil counts:
/// vignetted, and off the axis of different width along x and y.
/// Error with 128 samples: below 1e-3, from the cells at the rim.
MtfCurve diffraction_mtf(std::span<const SampledPupil> pupils, std::span<const double> frequencies,
                         MtfKind kind = MtfKind::diffraction);

/// The MTF of a field; `samples` as for `sample_pupils`.
MtfCurve diffraction_mtf(const PolychromaticField& field, std::span<const double> frequencies,
                         MtfKind kind = MtfKind::diffraction, int samples = 0);

/// How many rays the geometric MTF sums over. It is right while f times the change of position from one ray to the
/// next stays below half a cycle.
struct GeometricMtfSettings {
    int azimuths = 96;
    int rings = 32;
};

/// By rays alone: the mean of exp(−2πi f·position) over the beam's cross-section, by quadrature. Never folded; aliased
/// where the rays are too few for the highest frequency.
MtfCurve geometric_mtf(const PolychromaticField& field, std::span<const double> frequencies,
                       const GeometricMtfSettings& settings = {});

/// Beyond this frequency nothing is transferred: the beam's wider side over the wavelength, at the wavelength where
/// that is largest; cycles per mm.
double cutoff_frequency(const PolychromaticField& field);

}  // namespace lensproof::analysis
