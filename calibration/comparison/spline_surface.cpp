#include "calibration/comparison/spline_surface.h"

#include <algorithm>

#include "engine/base/parallel.h"

namespace lensproof::calibration {

namespace {

const double kPole = std::sqrt(3.0) - 2.0;
constexpr int kPoleReach = 30;    // |pole|³⁰ is 7e-18
constexpr int kNear = 1;          // coefficients before the first pixel
constexpr int kSplineMargin = 3;  // of them on both sides together
constexpr int kStrip = 256;       // columns that are filtered together

/// Samples mirrored about the first and the last.
int mirrored(int i, int count) {
    if (count == 1) {
        return 0;
    }
    const int period = 2 * (count - 1);
    const int place = ((i % period) + period) % period;
    return std::min(place, period - place);
}

/// The spline's coefficients of `count` samples: c_i of Σ c_i β(x − i), by a filter forth and back. `line` is read and
/// written through `at`, in which several lines stand side by side: each step is taken by all of them.
template <class At>
void to_coefficients(int count, int lines, const At& at) {
    if (count == 1) {
        return;
    }
    std::vector<double> state(static_cast<std::size_t>(lines), 0.0);
    // The causal sum's start over mirrored samples.
    double power = 1.0;
    for (int k = 0; k < kPoleReach; ++k, power *= kPole) {
        for (int line = 0; line < lines; ++line) {
            state[static_cast<std::size_t>(line)] += power * static_cast<double>(at(mirrored(k, count), line));
        }
    }
    std::vector<double> causal(static_cast<std::size_t>(count) * static_cast<std::size_t>(lines));
    const auto kept = [&](int i, int line) -> double& {
        return causal[static_cast<std::size_t>(i) * static_cast<std::size_t>(lines) + static_cast<std::size_t>(line)];
    };
    for (int line = 0; line < lines; ++line) {
        kept(0, line) = state[static_cast<std::size_t>(line)];
    }
    for (int i = 1; i < count; ++i) {
        for (int line = 0; line < lines; ++line) {
            kept(i, line) = static_cast<double>(at(i, line)) + kPole * kept(i - 1, line);
        }
    }
    const double last = kPole / (kPole * kPole - 1.0);
    for (int line = 0; line < lines; ++line) {
        kept(count - 1, line) = last * (kept(count - 1, line) + kPole * kept(count - 2, line));
        at(count - 1, line) = static_cast<float>(6.0 * kept(count - 1, line));
    }
    for (int i = count - 2; i >= 0; --i) {
        for (int line = 0; line < lines; ++line) {
            kept(i, line) = kPole * (kept(i + 1, line) - kept(i, line));
            at(i, line) = static_cast<float>(6.0 * kept(i, line));
        }
    }
}

}  // namespace

SplineSurface::SplineSurface(const formats::Image& image, int channel, int threads)
    : width_(image.width),
      height_(image.height),
      stride_(static_cast<std::size_t>(image.width + kSplineMargin)),
      coefficients_(stride_ * static_cast<std::size_t>(image.height + kSplineMargin)) {
    const auto place = [this](int x, int y) {
        return static_cast<std::size_t>(y + kNear) * stride_ + static_cast<std::size_t>(x + kNear);
    };
    parallel_for(height_, threads, [&](int y) {
        for (int x = 0; x < width_; ++x) {
            coefficients_[place(x, y)] = image.at(x, y, channel);
        }
        to_coefficients(width_, 1, [&](int x, int /*line*/) -> float& { return coefficients_[place(x, y)]; });
    });
    parallel_for((width_ + kStrip - 1) / kStrip, threads, [&](int strip) {
        const int first = strip * kStrip;
        to_coefficients(height_, std::min(kStrip, width_ - first),
                        [&](int y, int line) -> float& { return coefficients_[place(first + line, y)]; });
    });
    parallel_for(height_ + kSplineMargin, threads, [&](int row) {
        const int y = mirrored(row - kNear, height_);
        for (int x = -kNear; x < width_ + kSplineMargin - kNear; ++x) {
            if (const int from = mirrored(x, width_); from != x || y != row - kNear) {
                coefficients_[place(x, row - kNear)] = coefficients_[place(from, y)];
            }
        }
    });
}

}  // namespace lensproof::calibration
