// engine/render/sampling/path_sampler.h — the random numbers of a light path, however long it gets.
#pragma once
#include <array>
#include <cstdint>

#include "engine/render/sampling/sampler.h"

namespace lensproof::render {

/// Five numbers in (0, 1) after five, each set a pure function of (seed, pixel, sample) and how many sets were drawn
/// before. Within a set the samples of a pixel are a scrambled Sobol sequence, as `PixelSampler` has it; between sets
/// their order is shuffled by a nested uniform scramble of their index, so that no set follows from another (Burley,
/// "Practical hash-based Owen scrambling", JCGT 9(4), 2020, §4.3). A shuffle keeps aligned blocks of 2ⁿ samples
/// together, and with them their stratification.
class PathSampler {
  public:
    static constexpr int kNumbers = PixelSampler::kDimensions;

    PathSampler(std::uint64_t seed, std::uint32_t pixel, std::uint32_t sample)
        : seed_(seed), pixel_(pixel), sample_(sample) {}

    std::array<double, kNumbers> next() {
        // Set 0 belongs to the camera, which draws it as PixelSampler(seed, pixel) does.
        const std::uint64_t own = sampler_detail::mixed(seed_ + 0x6a09e667f3bcc909ULL * ++set_);
        const auto shuffle = static_cast<std::uint32_t>(sampler_detail::mixed(own ^ pixel_));
        return PixelSampler(own, pixel_).point(shuffled(sample_, shuffle));
    }

    /// What `next` will say, and as if it had said it.
    [[nodiscard]] std::array<double, kNumbers> peek() const { return PathSampler(*this).next(); }
    void skip() { ++set_; }

  private:
    /// Laine and Karras's hash acts on bits from the lowest up; an index is scrambled from the highest down.
    static std::uint32_t shuffled(std::uint32_t index, std::uint32_t seed) {
        return sampler_detail::reversed_bits(sampler_detail::laine_karras(sampler_detail::reversed_bits(index), seed));
    }

    std::uint64_t seed_;
    std::uint32_t pixel_;
    std::uint32_t sample_;
    std::uint64_t set_ = 0;
};

}  // namespace lensproof::render
