// engine/optics/packet/trace_batch.h — the tracer for many rays: in packets as wide as the machine has.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "engine/base/simd_level.h"
#include "engine/optics/packet/ray_batch.h"
#include "engine/optics/packet/spectral_lens.h"

namespace lensproof::optics {

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

/// The same for rays in someone else's memory.
template <Direction direction = Direction::forward, class T>
void trace_columns(const SpectralLens<T>& lens, const RayColumns<T>& rays, const BatchSettings& settings = {});

}  // namespace lensproof::optics
