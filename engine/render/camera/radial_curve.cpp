#include "engine/render/camera/radial_curve.h"

#include <cmath>

namespace lensproof::render {

RadialCurve::RadialCurve(double end, const std::vector<At>& nodes)
    : end_(end), per_step_(end > 0.0 ? static_cast<double>(nodes.size() - 1) / end : 0.0), nodes_(nodes) {
    const double step = end / static_cast<double>(nodes.size() - 1);
    std::ranges::for_each(nodes_, [&](At& node) { node.slope *= step; });
    const auto below = [](const At& a, const At& b) { return a.value < b.value; };
    const double range = nodes.back().value - nodes.front().value;
    if (!std::ranges::is_sorted(nodes_, below) || !(range > 0.0)) {
        return;
    }
    const std::size_t guides = 2 * nodes_.size();
    guides_per_value_ = static_cast<double>(guides) / range;
    std::int32_t node = 0;
    for (std::size_t i = 0; i < guides; ++i) {
        const double value = nodes.front().value + static_cast<double>(i) / guides_per_value_;
        while (node + 2 < static_cast<std::int32_t>(nodes_.size()) &&
               nodes_[static_cast<std::size_t>(node) + 1].value <= value) {
            ++node;
        }
        guides_.push_back(node);
    }
}

std::optional<double> RadialCurve::where(double value) const {
    if (guides_.empty() || !(value >= nodes_.front().value && value <= nodes_.back().value)) {
        return std::nullopt;
    }
    const auto guide = static_cast<std::size_t>((value - nodes_.front().value) * guides_per_value_);
    std::int32_t node = guides_[std::min(guide, guides_.size() - 1)];
    while (node + 2 < static_cast<std::int32_t>(nodes_.size()) &&
           nodes_[static_cast<std::size_t>(node) + 1].value < value) {
        ++node;
    }
    // Newton's steps from the chord: of pieces that are nearly straight, three take it down to the last digits.
    const Piece piece = piece_at(node);
    const double rise = piece.b + piece.c + piece.d;
    double t = (value - piece.a) / rise;
    constexpr int kMostSteps = 30;
    for (int step = 0; step < kMostSteps; ++step) {
        const double slope = piece.slope(t);
        const double next = std::clamp(t - (piece.value(t) - value) / (slope > 0.0 ? slope : rise), 0.0, 1.0);
        const bool is_found = std::abs(next - t) <= 1e-15 * t;
        t = next;
        if (is_found) {
            break;
        }
    }
    return (node + t) / per_step_;
}

std::vector<RadialCurve::At> RadialCurve::nodes() const {
    std::vector<At> nodes = nodes_;
    std::ranges::for_each(nodes, [&](At& node) { node.slope *= per_step_; });
    return nodes;
}

RadialCurve smooth_curve(double end, const std::vector<double>& values, Parity parity) {
    const auto last = static_cast<int>(values.size()) - 1;
    const double per_step = last / end;
    const auto value = [&](int i) {
        return i >= 0 ? values[static_cast<std::size_t>(i)]
                      : (parity == Parity::even ? 1.0 : -1.0) * values[static_cast<std::size_t>(-i)];
    };
    std::vector<RadialCurve::At> nodes;
    for (int i = 0; i <= last; ++i) {
        double rise = (value(i - 2) - 8.0 * value(i - 1)) / 12.0;
        if (i + 2 <= last) {
            rise += (8.0 * value(i + 1) - value(i + 2)) / 12.0;
        } else if (i + 1 == last) {
            rise =
                (3.0 * value(i + 1) + 10.0 * value(i) - 18.0 * value(i - 1) + 6.0 * value(i - 2) - value(i - 3)) / 12.0;
        } else {
            rise = (25.0 * value(i) - 48.0 * value(i - 1) + 36.0 * value(i - 2) - 16.0 * value(i - 3) +
                    3.0 * value(i - 4)) /
                   12.0;
        }
        nodes.push_back({value(i), rise * per_step});
    }
    return {end, nodes};
}

RadialCurve monotone_curve(double end, const std::vector<double>& values) {
    const std::size_t last = values.size() - 1;
    const double per_step = static_cast<double>(last) / end;
    std::vector<RadialCurve::At> nodes;
    for (std::size_t i = 0; i <= last; ++i) {
        double rise = 0.0;  // on the axis
        if (i == last) {
            rise = values[i] - values[i - 1];
        } else if (i > 0) {
            const double before = values[i] - values[i - 1];
            const double behind = values[i + 1] - values[i];
            const double least = std::min({std::abs(before), std::abs(behind), 0.25 * std::abs(before + behind)});
            rise = before * behind > 0.0 ? std::copysign(2.0 * least, before) : 0.0;
        }
        nodes.push_back({values[i], rise * per_step});
    }
    return {end, nodes};
}

}  // namespace lensproof::render
