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
        : at_{.seed = seed, .pixel = pixel, .sample = sample} {}

    [[gnu::always_inline]] std::array<double, kNumbers> next() {
        // Set 0 belongs to the camera, which draws it as PixelSampler(seed, pixel) does.
        const std::uint64_t own = own_seed(at_.seed, ++at_.set);
        return PixelSampler(own, at_.pixel).point(shuffled(at_.sample, shuffle(own, at_.pixel)));
    }

    /// What `next` will say, and as if it had said it.
    [[nodiscard, gnu::always_inline]] std::array<double, kNumbers> peek() const { return PathSampler(*this).next(); }
    /// As if it had said as many sets.
    void skip(std::uint64_t sets = 1) { at_.set += sets; }

    struct Place {
        std::uint64_t seed = 0;
        std::uint32_t pixel = 0;
        std::uint32_t sample = 0;
        std::uint64_t set = 0;  // the last that was drawn
    };
    [[nodiscard]] const Place& place() const { return at_; }

    // What numbers follow from (number_kernels.h).
    [[gnu::always_inline]] static std::uint64_t own_seed(std::uint64_t seed, std::uint64_t set) {
        return sampler_detail::mixed(seed + 0x6a09e667f3bcc909ULL * set);
    }
    [[gnu::always_inline]] static std::uint32_t shuffle(std::uint64_t own, std::uint32_t pixel) {
        return static_cast<std::uint32_t>(sampler_detail::mixed(own ^ pixel));
    }
    /// Laine and Karras's hash acts on bits from the lowest up; an index is scrambled from the highest down.
    [[gnu::always_inline]] static std::uint32_t shuffled(std::uint32_t index, std::uint32_t seed) {
        return sampler_detail::reversed_bits(sampler_detail::laine_karras(sampler_detail::reversed_bits(index), seed));
    }

  private:
    Place at_;
};

}  // namespace lensproof::render
