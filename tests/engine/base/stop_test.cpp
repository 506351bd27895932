// Work that is asked to stop ends soon, and only that work.
#include "engine/base/stop.h"

#include <gtest/gtest.h>

#include <atomic>

#include "engine/base/parallel.h"

namespace lensproof::stop_test {

TEST(Stop, EndsParallelWorkOnEveryThread) {
    for (const int threads : {1, 3}) {
        std::atomic<bool> stop = false;
        std::atomic<int> worked = 0;
        const StopScope scope(&stop);
        const auto work = [&](int i) {
            ++worked;
            if (i == 10) {
                stop = true;
            }
        };
        EXPECT_THROW(parallel_for(1'000'000, threads, work), Stopped);
        EXPECT_GE(worked, 11);
        EXPECT_LT(worked, 1'000'000);
    }
}

// Inner work is the outer's, on whichever thread it came to run.
TEST(Stop, ReachesNestedWork) {
    std::atomic<bool> stop = false;
    std::atomic<int> inner = 0;
    const StopScope scope(&stop);
    EXPECT_THROW(parallel_for(4, 2,
                              [&](int) {
                                  parallel_for(1000, 2, [&](int) {
                                      ++inner;
                                      stop = true;
                                  });
                              }),
                 Stopped);
    EXPECT_LT(inner, 4000);
}

TEST(Stop, IsNobodyElses) {
    std::atomic<bool> stop = true;
    {
        const StopScope scope(&stop);
        EXPECT_THROW(stop_if_asked(), Stopped);
        const StopScope unasked(nullptr);
        EXPECT_NO_THROW(stop_if_asked());
    }
    int worked = 0;
    parallel_for(100, 1, [&](int) { ++worked; });
    EXPECT_EQ(worked, 100);
}

}  // namespace lensproof::stop_test
