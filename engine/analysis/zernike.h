// engine/analysis/zernike.h — Zernike's circle polynomials, their numberings, and least-squares fits of wavefronts.
#pragma once
#include <span>
#include <vector>

#include "engine/analysis/wavefront.h"

namespace lensproof::analysis {

/// A circle polynomial: radial degree n ≥ 0, and azimuthal frequency m with |m| ≤ n and n − |m| even; m > 0 goes with
/// cos mθ, m < 0 with sin |m|θ, and θ counts from +x towards +y.
struct ZernikeMode {
    int n = 0;
    int m = 0;
    friend bool operator==(const ZernikeMode&, const ZernikeMode&) = default;
};

/// Noll's single index, from 1 (Noll, J. Opt. Soc. Am. 66, 207 (1976), table 1): even with cosines, odd with sines.
int noll_index(ZernikeMode mode);

/// The index of ANSI Z80.28 and OSA, from 0: (n (n + 2) + m) / 2.
int ansi_index(ZernikeMode mode);
ZernikeMode mode_of_ansi(int index);

/// How many polynomials have degree up to `degree`.
constexpr int zernike_count(int degree) {
    return (degree + 1) * (degree + 2) / 2;
}

/// All polynomials up to `degree` at a point (x, y) of the unit disc, in Noll's order (index 1 first), normalised so
/// that each has mean square 1 over the disc: √(n+1) R_n^0, or √(2(n+1)) R_n^|m| cos or sin.
///
/// Radial polynomials by R_n^m = r (R_{n−1}^{|m−1|} + R_{n−1}^{m+1}) − R_{n−2}^m (Shakibaei and Paramesran, Opt. Lett.
/// 38, 2487 (2013)), which loses no digits at high degree as the sums of factorials do.
std::vector<double> zernike_values(int degree, Vec2d point);

/// A value at a point of the unit disc.
struct ZernikeSample {
    Vec2d point;
    double value = 0.0;
    double weight = 1.0;
};

/// Coefficients in Noll's order (index 1 first), in the unit of the values.
struct ZernikeFit {
    int degree = 0;
    std::vector<double> coefficients;
    double residual_rms = 0.0;  // weighted

    [[nodiscard]] double noll(int index) const { return coefficients.at(static_cast<std::size_t>(index) - 1); }
    [[nodiscard]] double ansi(int index) const { return noll(noll_index(mode_of_ansi(index))); }
};

/// Weighted least squares. Over the whole disc the coefficients are the projections; over a vignetted pupil, where the
/// polynomials are not orthogonal, they are the best fit there, and the one of least norm where the samples do not tell
/// some apart. Throws InputError for fewer samples than polynomials.
ZernikeFit fit_zernike(std::span<const ZernikeSample> samples, int degree);

/// The radius, in direction cosines, of the smallest circle about the chief ray that holds the whole beam on its
/// reference sphere: the unit disc for `wavefront_zernike`. 0 where no light passes.
double pupil_radius(const optics::TraceLens<double>& lens, const optics::FieldBundle& bundle,
                    const ReferenceSphere& sphere, const optics::RegionOutline& outline);

/// The wavefront in waves over the exit pupil as seen from the image point: x, y are the direction cosines on the
/// reference sphere less the chief ray's, over `radius`.
ZernikeFit wavefront_zernike(const Wavefront& wavefront, double radius, int degree);

}  // namespace lensproof::analysis
