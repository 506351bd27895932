// engine/base/stop.h — work that its caller no longer wants ends early.
#pragma once
#include <atomic>

namespace lensproof {

/// Thrown by work that was asked to stop. No std::exception, so that nobody who expects those takes it for a failure
/// that can be lived with.
struct Stopped {};

/// While it lives, work of this thread, and of the threads that `parallel_for` starts for it, looks at the flag and
/// ends by throwing Stopped once that is set. Null: nobody asks. The flag outlives it. Scopes nest; the innermost
/// counts.
class StopScope {
  public:
    explicit StopScope(const std::atomic<bool>* flag) : outer_(current()) { current() = flag; }
    ~StopScope() { current() = outer_; }
    StopScope(const StopScope&) = delete;
    StopScope& operator=(const StopScope&) = delete;

    /// This thread's flag, null where nobody asks.
    static const std::atomic<bool>*& current() {
        thread_local const std::atomic<bool>* flag = nullptr;
        return flag;
    }

  private:
    const std::atomic<bool>* outer_;
};

/// Throws Stopped where this thread was asked to stop.
inline void stop_if_asked() {
    const std::atomic<bool>* const flag = StopScope::current();
    if (flag != nullptr && flag->load(std::memory_order_relaxed)) {
        throw Stopped();
    }
}

}  // namespace lensproof
