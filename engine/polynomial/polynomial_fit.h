// engine/polynomial/polynomial_fit.h — fits sparse polynomials to a lens until their error is the wanted one.
#pragma once
#include <vector>

#include "engine/base/cache.h"
#include "engine/optics/lens.h"
#include "engine/polynomial/polynomial_lens.h"
#include "engine/pupil/pupil_map.h"

namespace lensproof::polynomial {

struct FitSettings {
    /// The error on the film that terms are added for, µm rms over rays held out (PolynomialError::rms_um).
    double wanted_um = 1.5;
    /// How far rays may lie beside the traced ones at the front, over their largest distance from the beam's middle.
    double wanted_entry = 5e-4;
    double wanted_transmittance = 5e-4;
    double wanted_rim = 2e-3;  // of r² over the rim's square, near the rim
    int fitted_rays = 5000;
    int held_out_rays = 4000;  // that say when to stop
    int judging_rays = 20000;  // that the error is measured with which is stated
    int most_terms = 240;      // of a vector
};

/// The lens, stopped down and focused, at the wavelengths that `pupil` has, over the film within `film_radius_mm`.
///
/// Terms are chosen from all of a degree (sparse_fit.h), first for where rays leave, then for their direction: the
/// latter so that rays land right on the film given the former, weighed by how the exact landing moves with it. Degrees
/// rise until rays held out land within the wanted error, or no more terms help: the error that is reached is said, not
/// thrown. The same lens makes the same polynomials.
///
/// Throws InputError for a lens that is not rotationally symmetric, that has mirrors, or whose stop has blades or a
/// texture, which no polynomial in these terms can follow, and where hardly any light comes through.
PolynomialLens fit_polynomial(const optics::Lens& lens, const std::vector<double>& wavelengths_nm,
                              const pupil::PupilMap& pupil, double film_radius_mm, const FitSettings& settings = {});

/// How far a polynomial is from its lens, by `count` rays of the set that RaySampler draws, from `first` on.
PolynomialError measured_error(const PolynomialLens& polynomial, const std::vector<optics::TraceLens<double>>& lenses,
                               const pupil::PupilMap& pupil, std::uint64_t first, int count);

/// The same from the cache, where that has it of these very numbers, made by a program of these very sources; else it
/// is made, and kept.
PolynomialLens kept_polynomial(const Cache& cache, const optics::Lens& lens, const std::vector<double>& wavelengths_nm,
                               const pupil::PupilMap& pupil, double film_radius_mm, const FitSettings& settings = {});

}  // namespace lensproof::polynomial
