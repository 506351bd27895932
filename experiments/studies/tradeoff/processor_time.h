// experiments/studies/tradeoff/processor_time.h — how long the processor has worked.
#pragma once
#include <ctime>

namespace lensproof::studies {

/// In all threads of the process, or (CLOCK_THREAD_CPUTIME_ID) in this one, s.
inline double processor_seconds(clockid_t clock = CLOCK_PROCESS_CPUTIME_ID) {
    timespec now{};
    clock_gettime(clock, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace lensproof::studies
