#include "experiments/cli/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>

#include "engine/base/visible.h"

namespace lensproof::cli {

namespace {

constexpr auto kRedraw = std::chrono::milliseconds(100);
constexpr int kBarWidth = 30;

}  // namespace

double seconds_since(std::chrono::steady_clock::time_point then) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - then).count();
}

ProgressBar::ProgressBar(std::string_view label, bool quiet)
    : label_(visible_in_line(label)),
      shown_(!quiet && ::isatty(STDERR_FILENO) == 1),
      start_(std::chrono::steady_clock::now()) {}

ProgressBar::~ProgressBar() {
    if (shown_) {
        std::fputs("\r\033[K", stderr);
    }
}

bool ProgressBar::is_due() {
    if (!shown_ || std::chrono::steady_clock::now() - drawn_ < kRedraw) {
        return false;
    }
    drawn_ = std::chrono::steady_clock::now();
    return true;
}

void ProgressBar::update(double done) {
    const double fraction = std::clamp(done, 0.0, 1.0);
    update(fraction, fraction > 0.0 ? seconds_since(start_) * (1.0 - fraction) / fraction : 0.0, "");
}

void ProgressBar::update(double done, double seconds_left, const std::string& note) {
    if (!is_due()) {
        return;
    }
    const double fraction = std::clamp(done, 0.0, 1.0);
    const int full = static_cast<int>(fraction * kBarWidth);
    const std::string line =
        fmt::format("\r{} [{:#<{}}{:.<{}}] {:3.0f} %, {}{:.0f} s left\033[K", label_, "", full, "", kBarWidth - full,
                    100.0 * fraction, note.empty() ? "" : note + ", ", seconds_left);
    std::fputs(line.c_str(), stderr);
    std::fflush(stderr);
}

}  // namespace lensproof::cli
