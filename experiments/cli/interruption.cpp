#include "experiments/cli/interruption.h"

#include <atomic>

#include "engine/base/stop.h"

namespace lensproof::cli {

namespace {

// A handler reaches nothing but what is global.
std::atomic<bool> came = false;
static_assert(std::atomic<bool>::is_always_lock_free, "a handler may set it");

}  // namespace

Interruption::Interruption() : takes_signals_(StopScope::current() == nullptr) {
    came = false;
    for (std::size_t i = 0; takes_signals_ && i < kSignals.size(); ++i) {
        ::sigaction(kSignals[i], nullptr, &before_[i]);
        if (before_[i].sa_handler != SIG_IGN) {
            struct sigaction note {};
            note.sa_handler = [](int) { came = true; };
            note.sa_flags = static_cast<int>(SA_RESETHAND) | SA_RESTART;
            ::sigaction(kSignals[i], &note, nullptr);
        }
    }
}

Interruption::~Interruption() {
    for (std::size_t i = 0; takes_signals_ && i < kSignals.size(); ++i) {
        ::sigaction(kSignals[i], &before_[i], nullptr);
    }
}

bool Interruption::has_come() {
    return came;
}

}  // namespace lensproof::cli
