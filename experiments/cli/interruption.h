// experiments/cli/interruption.h — Ctrl-C and its like as a question, for commands that have something to save.
#pragma once
#include <array>
#include <csignal>

namespace lensproof::cli {

/// While it lives, SIGINT, SIGTERM and SIGHUP are noted rather than obeyed: the first of them, a second one ends the
/// program at once. Those that the program was started to ignore, as `nohup` does, stay ignored; and all are left to
/// whoever has this thread's work stopped in another way (engine/base/stop.h). One at a time.
class Interruption {
  public:
    Interruption();
    ~Interruption();
    Interruption(const Interruption&) = delete;
    Interruption& operator=(const Interruption&) = delete;

    /// Whether one has come. May be asked by any thread.
    [[nodiscard]] static bool has_come();

  private:
    static constexpr std::array<int, 3> kSignals = {SIGINT, SIGTERM, SIGHUP};
    bool takes_signals_;
    std::array<struct sigaction, kSignals.size()> before_{};
};

}  // namespace lensproof::cli
