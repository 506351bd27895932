// tests/trials.h — how many trials a statistic has.
#pragma once
#include <cstdlib>

namespace lensproof {

/// As many as it takes to be sure are for LENSPROOF_ALL_TRIALS=1, by hand; a few for every day.
template <class Count>
Count trials(Count all, Count few) {
    return std::getenv("LENSPROOF_ALL_TRIALS") != nullptr ? all : few;  // NOLINT(concurrency-mt-unsafe)
}

}  // namespace lensproof
