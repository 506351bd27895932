// engine/formats/prescription/forbes_asphere.h — aspheres in Forbes's polynomials, as powers of r.
#pragma once
#include <span>

#include "engine/optics/prescription.h"

namespace lensproof::formats {

/// How many of Forbes's polynomials, of either kind, the powers up to r²⁰ make.
inline constexpr int kForbesTerms = optics::kAsphereTerms - 1;

/// The coefficients of r², r⁴, … of Forbes's strong departure from a conic,
///     u⁴ Σ a_m Qcon_m(u²),   u = r / radius,   m = 0 … kForbesTerms − 1,
/// in which Qcon_m(x) = P_m^(0,4)(2 x − 1), Jacobi's polynomials (G. W. Forbes, "Shape specification for axially
/// symmetric optical surfaces", Opt. Express 15, 5218, 2007). Formed in long double. Rounding the
/// powers' coefficients, of alternating signs, leaves at most 5e-10 of a_8 and less of the others: 0.5 fm of 1 µm.
optics::AsphereTerms powers_of_qcon(std::span<const double> a, double radius);

/// Likewise of his mild departure, which counts along the conic's normal (PrescribedSurface::along_normal),
///     u² (1 − u²) Σ a_m Qbfs_m(u²),
/// polynomials whose slopes are orthogonal over the aperture (eq. 2.7 there). Recurrences: G. W. Forbes, "Robust,
/// efficient computational methods for axially symmetric optical aspheres", Opt. Express 18, 19700 (2010), appendix A.
/// Rounding leaves at most 2e-10 of a_8 and less of the others.
optics::AsphereTerms powers_of_qbfs(std::span<const double> a, double radius);

}  // namespace lensproof::formats
