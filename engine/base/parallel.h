// engine/base/parallel.h — independent pieces of work on several threads.
#pragma once
#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

#include "engine/base/stop.h"

namespace lensproof {

/// Calls make_worker() on up to `threads` threads (0: one a core), and what it returned with every i in [0, count), in
/// no particular order, each i on one of them; then done(finished) under a lock after each. So a worker may own
/// memory that it needs for every i. The first exception stops the rest and is thrown here; so does Stopped where the
/// calling thread was asked to stop (engine/base/stop.h).
template <class MakeWorker, class Done>
void parallel_for_workers(int count, int threads, const MakeWorker& make_worker, const Done& done) {
    const int available = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
    const int workers = std::clamp(threads > 0 ? threads : available, 1, std::max(1, count));
    std::atomic<int> next{0};
    std::mutex mutex;
    int finished = 0;
    std::exception_ptr failure;
    const std::atomic<bool>* const stop = StopScope::current();
    const auto run = [&] {
        const StopScope scope(stop);
        try {
            auto work = make_worker();
            for (int i = next++; i < count; i = next++) {
                work(i);
                {
                    const std::scoped_lock lock(mutex);
                    done(++finished);
                }
                stop_if_asked();  // not between an i's being taken and its work, which others may wait for
            }
        } catch (...) {
            const std::scoped_lock lock(mutex);
            failure = std::current_exception();
            next = count;
        }
    };
    {
        std::vector<std::jthread> pool;
        for (int i = 1; i < workers; ++i) {
            pool.emplace_back(run);
        }
        run();
    }
    if (failure) {
        std::rethrow_exception(failure);
    }
}

/// The same where workers own nothing: calls work(i).
template <class Work, class Done>
void parallel_for(int count, int threads, const Work& work, const Done& done) {
    parallel_for_workers(
        count, threads, [&work] { return [&work](int i) { work(i); }; }, done);
}

template <class Work>
void parallel_for(int count, int threads, const Work& work) {
    parallel_for(count, threads, work, [](int /*finished*/) {});
}

}  // namespace lensproof
