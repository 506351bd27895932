// engine/render/stray/walk_numbers.h — the random numbers of a walk inside a lens, however long it gets.
#pragma once
#include <array>
#include <cstdint>

#include "engine/render/sampling/path_sampler.h"

namespace lensproof::render {

/// As many numbers as a walk takes, from the last two of a light path's five (SplitMix64).
class WalkNumbers {
  public:
    explicit WalkNumbers(const std::array<double, PathSampler::kNumbers>& seed)
        : state_((static_cast<std::uint64_t>(seed[3] * 0x1p32) << 32U) | static_cast<std::uint64_t>(seed[4] * 0x1p32)) {
    }

    double operator()() {
        state_ += 0x9e3779b97f4a7c15ULL;
        return (static_cast<double>(sampler_detail::mixed(state_) >> 12U) + 0.5) * 0x1p-52;
    }

  private:
    std::uint64_t state_;
};

}  // namespace lensproof::render
