// experiments/cli/progress.h — a progress line on standard error, on a terminal only.
#pragma once
#include <chrono>
#include <functional>
#include <string>
#include <string_view>

namespace lensproof::cli {

/// Of wall-clock time.
double seconds_since(std::chrono::steady_clock::time_point then);

/// Draws "label [####....] 42 %, 12 s left" while work goes on; clears the line at the end of its life.
class ProgressBar {
  public:
    /// Silent when `quiet`, or when standard error is not a terminal.
    ProgressBar(std::string_view label, bool quiet);
    ~ProgressBar();
    ProgressBar(const ProgressBar&) = delete;
    ProgressBar& operator=(const ProgressBar&) = delete;

    /// `done` from 0 to 1. To be called by one thread at a time.
    void update(double done);

    /// The same for work that knows better how long it takes, and has something to add, such as its speed.
    void update(double done, double seconds_left, const std::string& note);

  private:
    /// Whether it is time to draw the line again.
    bool is_due();

    std::string label_;
    bool shown_;
    std::chrono::steady_clock::time_point start_;
    std::chrono::steady_clock::time_point drawn_;
};

}  // namespace lensproof::cli
