// engine/polynomial/polynomial_kernels.h — the loop that evaluates polynomials, one for each width of packets.
#pragma once
#include <cstdint>
#include <optional>

#include "engine/base/simd_level.h"
#include "engine/optics/packet/ray_batch.h"
#include "engine/polynomial/symmetric_map.h"

namespace lensproof::polynomial {

/// A PolynomialLens as plain arrays.
struct PolynomialTables {
    const SymmetricMap::Monomial* monomials = nullptr;
    int monomial_count = 0;
    const std::int32_t* first_term = nullptr;  // of the sums, as SymmetricMap has them: w, u, transmittance, rims
    const std::uint16_t* term_monomial = nullptr;
    const double* coefficients = nullptr;
    int rims = 0;
    const double* band = nullptr;  // t of each wavelength
    double per_film = 1.0;         // as PolynomialFrame has them; 1 / a radius
    double pupil_shear = 0.0;
    double per_pupil = 1.0;
    double front_curvature = 0.0;
};

/// Film and pupil points of rays, mm; columns aligned and as long as packets want them (kPacketAlignment, kMostLanes).
struct FilmRays {
    const double* film_x;
    const double* film_y;
    const double* pupil_x;
    const double* pupil_y;
    const std::uint16_t* wavelength;
    int size;
};

struct PolynomialKernels {
    /// `PolynomialLens::exit` of each: origin, direction and transmittance into the batch. All levels yield the same
    /// bits.
    void (*find_exits)(const PolynomialTables& tables, const FilmRays& from, optics::RayBatch<double>& rays);
};

/// Those of a level, or of the widest; throws as `LoopsByLevel` does.
const PolynomialKernels& polynomial_kernels(std::optional<SimdLevel> level = {});

/// Compiled for each level by itself (.ci/rooms.cmake).
template <SimdLevel level>
PolynomialKernels polynomial_kernels_at();

}  // namespace lensproof::polynomial
