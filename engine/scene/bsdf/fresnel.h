// engine/scene/bsdf/fresnel.h — the fraction of unpolarised light that a smooth boundary reflects.
#pragma once
#include <cmath>

#include "engine/optics/refract.h"
#include "engine/spectral/spectral_sample.h"

namespace lensproof::scene {

/// A dielectric's, for light from a medium of index 1 that meets one of index `eta` at `cos_incidence` in [0, 1]: 1 in
/// total reflection. (1 − T of Born & Wolf, §1.5.2.)
inline double dielectric_reflectance(double eta, double cos_incidence) {
    const double sin2_incidence = (1.0 - cos_incidence) * (1.0 + cos_incidence);
    const double ratio = 1.0 / eta;
    const auto [cos_after, transmitted] = optics::cos_refraction(cos_incidence, sin2_incidence, ratio);
    return transmitted ? 1.0 - optics::fresnel_transmittance(ratio, cos_incidence, cos_after).value() : 1.0;
}

/// A conductor's of index n + ik relative to the medium before it, at `cos_incidence` in [0, 1].
///
/// With (a + ib)² = (n + ik)² − sin² i, the Fresnel formulae for a complex index (Born & Wolf, §14.2) give
///     R_s = ((a − c)² + b²) / ((a + c)² + b²),   R_p = R_s ((a c − s²)² + b² c²) / ((a c + s²)² + b² c²),
/// c = cos i, s = sin i. Of a² and b², whose sum is |(n + ik)² − s²|, the larger is taken from the sum and the lesser
/// from a b = n k, which keeps a good mirror's small losses.
inline spectral::SpectralSample conductor_reflectance(const spectral::SpectralSample& n,
                                                      const spectral::SpectralSample& k, double cos_incidence) {
    const auto c = static_cast<float>(cos_incidence);
    const auto s2 = static_cast<float>((1.0 - cos_incidence) * (1.0 + cos_incidence));
    const auto square = [](float x) { return x * x; };
    return spectral::for_each_wavelength(
        [&](float real, float imaginary) {
            const float difference = (real - imaginary) * (real + imaginary) - s2;  // a² − b²
            const float product = real * imaginary;                                 // a b
            const float sum = std::sqrt(square(difference) + 4.0F * square(product));
            const float larger = std::sqrt(0.5F * (sum + std::abs(difference)));
            const float lesser = larger > 0.0F ? product / larger : 0.0F;
            const float a = difference < 0.0F ? lesser : larger;
            const float b2 = square(difference < 0.0F ? larger : lesser);
            const float s = (square(a - c) + b2) / (square(a + c) + b2);
            const float p = s * (square(a * c - s2) + b2 * c * c) / (square(a * c + s2) + b2 * c * c);
            return 0.5F * (s + p);
        },
        n, k);
}

}  // namespace lensproof::scene
