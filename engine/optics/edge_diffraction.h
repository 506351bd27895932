// engine/optics/edge_diffraction.h — what the edge of a stop's blade diffracts, by the geometrical theory and the
// uniform one.
//
// A blade is taken as a half-plane that nothing passes. Angles are in radians, in the plane across the edge, from the
// blade's lit face: the light comes from `incidence`, the diffracted ray leaves towards `diffraction` (0 to 2π), so
// that light which goes straight on leaves at incidence + π, where the shadow begins. `cone` is the angle between the
// edge and either ray, which Keller's law has equal. Phases are those of exp(iωt): a wave that travels r has turned by
// exp(−ikr).
#pragma once
#include <complex>

namespace lensproof::optics {

struct EdgeAngles {
    double incidence = 0.0;
    double diffraction = 0.0;
    double cone = 0.0;  // not 0
};

/// D of a field that is D · exp(−iks) / √s times the incident one at the edge, at the distance s mm behind a straight
/// edge in a plane wave. √mm.
struct EdgeCoefficients {
    std::complex<double> soft;  // of the electric field along the edge
    std::complex<double> hard;  // across it

    /// |D|² of unpolarised light, mm.
    [[nodiscard]] double unpolarised() const { return 0.5 * (std::norm(soft) + std::norm(hard)); }
};

/// F(x) = 2i √x exp(ix) ∫_√x^∞ exp(−iτ²) dτ for x ≥ 0: from √(πx) exp(i(π/4 + x)) where x is small to 1 far from the
/// shadow's boundary (Kouyoumjian and Pathak, Proc. IEEE 62, 1974, eq. 26). To 1e-13.
std::complex<double> transition_function(double x);

/// Keller's coefficients (J. Opt. Soc. Am. 52, 1962, eq. 2): infinite where light goes straight on and where it is
/// mirrored. `wavenumber` is 2π/λ in 1/mm.
EdgeCoefficients keller_coefficients(const EdgeAngles& angles, double wavenumber);

/// Those of the uniform theory (Kouyoumjian and Pathak, eq. 25, for a half-plane), finite everywhere: each jumps where
/// the light that goes straight on, or is mirrored, does, so that their sum does not. `distance` is their L, mm:
/// s sin² β in a plane wave, s s′ sin² β / (s + s′) at s from the edge where light comes from a point at s′.
EdgeCoefficients uniform_coefficients(const EdgeAngles& angles, double wavenumber, double distance);

}  // namespace lensproof::optics
