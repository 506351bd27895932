#include "experiments/cli/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>

namespace lensproof {

namespace {

using Clock = std::chrono::steady_clock;
constexpr auto kRedraw = std::chrono::milliseconds(100);
constexpr int kBarWidth = 30;

double seconds_since(Clock::time_point then) {
    return std::chrono::duration<double>(Clock::now() - then).count();
}

}  // namespace

ProgressBar::ProgressBar(std::string label, bool quiet)
    : label_(std::move(label)), shown_(!quiet && ::isatty(STDERR_FILENO) == 1), start_(Clock::now()) {}

ProgressBar::~ProgressBar() {
    if (shown_) {
        std::fputs("\r\033[K", stderr);
    }
}

void ProgressBar::update(double done) {
    if (!shown_ || Clock::now() - drawn_ < kRedraw) {
        return;
    }
    drawn_ = Clock::now();
    const double share = std::clamp(done, 0.0, 1.0);
    const int full = static_cast<int>(share * kBarWidth);
    const double left = share > 0.0 ? seconds_since(start_) * (1.0 - share) / share : 0.0;
    const std::string line = fmt::format("\r{} [{:#<{}}{:.<{}}] {:3.0f} %, {:.0f} s left\033[K", label_, "", full, "",
                                         kBarWidth - full, 100.0 * share, left);
    std::fputs(line.c_str(), stderr);
    std::fflush(stderr);
}

}  // namespace lensproof
