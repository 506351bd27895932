#include "engine/render/sampling/pixel_filter.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "engine/base/input_error.h"

namespace lensproof::render {

namespace {

constexpr double kWindowRadius = 1.5;

double tent(double x) {
    return 1.0 - std::abs(x);
}

double flat(double /*x*/) {
    return 1.0;
}

double gaussian(double x) {
    return std::exp(-2.0 * x * x) - std::exp(-2.0 * kWindowRadius * kWindowRadius);
}

double blackman_harris(double x) {
    const double phase = std::numbers::pi * (x / kWindowRadius + 1.0);
    return 0.35875 - 0.48829 * std::cos(phase) + 0.14128 * std::cos(2.0 * phase) - 0.01168 * std::cos(3.0 * phase);
}

/// Equation 8 of the paper, times 18.
double mitchell(double x) {
    const double t = std::abs(x);
    return t < 1.0 ? (21.0 * t - 36.0) * t * t + 16.0 : ((-7.0 * t + 36.0) * t - 60.0) * t + 32.0;
}

struct KnownFilter {
    const char* name;
    double (*shape)(double);
    double radius_px;
};

constexpr std::array<KnownFilter, 4> kFilters{{{"tent", tent, 1.0},
                                               {"gaussian", gaussian, kWindowRadius},
                                               {"blackman-harris", blackman_harris, kWindowRadius},
                                               {"mitchell", mitchell, 2.0}}};

constexpr int kParts = 1024;  // of equal chance, that draws are even within
constexpr int kCells = 16 * kParts;

}  // namespace

PixelFilter PixelFilter::named(const std::string& name) {
    if (name == "box") {
        return {};
    }
    const auto* const known = std::ranges::find(kFilters, name, &KnownFilter::name);
    if (known == kFilters.end()) {
        throw InputError(
            fmt::format("pixel filter \"{}\" is not known, expected one of {}", name, fmt::join(known_names(), ", ")));
    }
    return {known->name, known->shape, known->radius_px};
}

PixelFilter PixelFilter::square(double fraction) {
    return fraction < 1.0 ? PixelFilter(fmt::format("box-{}", fraction), flat, 0.5 * std::sqrt(fraction))
                          : PixelFilter();
}

std::vector<std::string> PixelFilter::known_names() {
    std::vector<std::string> names = {"box"};
    for (const KnownFilter& known : kFilters) {
        names.emplace_back(known.name);
    }
    return names;
}

PixelFilter::PixelFilter(std::string name, Shape shape, double radius_px)
    : name_(std::move(name)), shape_(shape), radius_px_(radius_px) {
    // Simpson's rule for the integral; for the quantiles, which weights make up for, the midpoints' sums of |f| do.
    const double cell = 2.0 * radius_px / kCells;
    double integral = 0.0;
    std::vector<double> below = {0.0};
    for (int i = 0; i < kCells; ++i) {
        const double from = i * cell - radius_px;
        const double middle = shape(from + 0.5 * cell);
        integral += (shape(from) + 4.0 * middle + shape(from + cell)) * cell / 6.0;
        below.push_back(below.back() + std::abs(middle));
    }
    scale_ = 1.0 / integral;
    for (int k = 0, i = 1; k < kParts; ++k) {
        const double wanted = below.back() * k / kParts;
        while (below[static_cast<std::size_t>(i)] <= wanted) {
            ++i;
        }
        const double before = below[static_cast<std::size_t>(i) - 1];
        const double within = (wanted - before) / (below[static_cast<std::size_t>(i)] - before);
        quantile_.push_back((i - 1 + within) * cell - radius_px);
    }
    quantile_.push_back(radius_px);
}

double PixelFilter::operator()(double offset_px) const {
    if (is_box()) {
        return offset_px >= -0.5 && offset_px < 0.5 ? 1.0 : 0.0;
    }
    return std::abs(offset_px) < radius_px_ ? scale_ * shape_(offset_px) : 0.0;
}

PixelFilter::Draw PixelFilter::draw(double u) const {
    if (is_box()) {
        return {.offset_px = u - 0.5};
    }
    const auto part = static_cast<std::size_t>(std::clamp(static_cast<int>(u * kParts), 0, kParts - 1));
    const double width = quantile_[part + 1] - quantile_[part];
    const double offset = quantile_[part] + (u * kParts - static_cast<double>(part)) * width;
    return {.offset_px = offset, .weight = scale_ * shape_(offset) * width * kParts};
}

}  // namespace lensproof::render
