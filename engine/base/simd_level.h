// engine/base/simd_level.h — how wide this machine's packets can be.
#pragma once
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

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

/// A set of loops for each available level.
template <class Loops>
class LoopsByLevel {
  public:
    /// Of `make.operator()<level>()`, which is made of the level's instructions: it is not called where the machine
    /// lacks them.
    template <class Make>
    explicit LoopsByLevel(const Make& make) {
        for (const SimdLevel level : available_simd_levels()) {
            loops_.emplace(level, made_at(level, make));
        }
    }

    /// Those of a level, or of the widest. Throws std::invalid_argument where the level is not available.
    [[nodiscard]] const Loops& at(std::optional<SimdLevel> level) const {
        const auto entry = level ? loops_.find(*level) : std::prev(loops_.end());
        if (entry == loops_.end()) {
            throw std::invalid_argument(std::string("this machine has no ") + simd_name(*level));
        }
        return entry->second;
    }

  private:
    template <class Make>
    static Loops made_at(SimdLevel level, const Make& make) {
        switch (level) {
#ifdef LENSPROOF_X86_KERNELS
            case SimdLevel::avx512:
                return make.template operator()<SimdLevel::avx512>();
            case SimdLevel::avx2:
                return make.template operator()<SimdLevel::avx2>();
#endif
            case SimdLevel::baseline:
                return make.template operator()<SimdLevel::baseline>();
            default:
                return make.template operator()<SimdLevel::scalar>();
        }
    }

    std::map<SimdLevel, Loops> loops_;
};

}  // namespace lensproof
