// engine/optics/polygon_transform.h — the far field of an opening with straight edges.
#pragma once
#include <complex>
#include <span>

#include "engine/base/vec.h"

namespace lensproof::optics {

/// ∫ exp(−i k·x) d²x over a polygon, in closed form: what it diffracts to the angles k λ/2π far away or in a lens's
/// focus, times iλz (Born & Wolf, Principles of Optics, 7th ed., §8.3, eq. 39). `corners` run around it either way, mm;
/// `k` in 1/mm; k = 0 gives the area.
///
/// Stokes's theorem leaves a sum over the edges, Σ i (k × e) sinc(k·e/2) exp(−i k·m) / |k|² with e along an edge and m
/// its middle (Lee and Mittra, IEEE Trans. Antennas Propag. 31, 1983): no grid, and no error that a grid makes. Of the
/// area, the rounding of the sum is some 1e-16 / (|k| · the polygon's radius).
std::complex<double> polygon_transform(std::span<const Vec2d> corners, const Vec2d& k);

}  // namespace lensproof::optics
