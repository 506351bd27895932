// engine/optics/packet/trace_batch.h — the tracer for many rays: in packets as wide as the machine has.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "engine/optics/packet/ray_batch.h"
#include "engine/optics/packet/spectral_lens.h"

namespace lensproof {

/// How many lanes a packet has: one, or as many as a register of the named instructions holds.
enum class SimdLevel {
    scalar,    // one ray at a time, on any machine
    baseline,  // what every machine of the build's architecture has: SSE2, NEON
    avx2,
    avx512,
};

/// "scalar", "baseline", "avx2", "avx512".
const char* simd_name(SimdLevel level);

/// The levels that this build has and this machine runs, narrowest first; never empty.
std::vector<SimdLevel> available_simd_levels();

/// What is found of a ray besides its points and directions: each costs time.
enum class Carry {
    geometry,       // nothing
    transmittance,  // Fresnel's and coatings' losses
    all,            // that and the optical path
};

struct BatchSettings {
    Carry carry = Carry::all;
    Rims rims = Rims::clip;
    std::optional<SimdLevel> level;  // nothing: the widest available; throws std::invalid_argument where it is not
};

/// `trace` for the first `rays.size` rays of a batch, each at its own wavelength of `lens`. Every ray ends with the
/// bits of the scalar `trace` at any level, whatever its neighbours do: origin, direction, status, surface, and what
/// `settings` asks to carry (else those columns keep what they had).
template <Direction direction = Direction::forward, class T>
void trace_batch(const SpectralLens<T>& lens, RayBatch<T>& rays, const BatchSettings& settings = {});

}  // namespace lensproof
