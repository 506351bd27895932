#include "engine/render/camera/radial_curve.h"

#include <cmath>
#include <cstdint>
#include <utility>

#include "engine/base/bisect.h"
#include "engine/base/bytes.h"

namespace lensproof::render {

RadialCurve::RadialCurve(double end, const std::vector<At>& nodes)
    : end_(end), per_step_(end > 0.0 ? static_cast<double>(nodes.size() - 1) / end : 0.0), nodes_(nodes) {
    const double step = end / static_cast<double>(nodes.size() - 1);
    std::ranges::for_each(nodes_, [&](At& node) { node.slope *= step; });
}

void RadialCurve::append_pieces(std::vector<double>& pieces) const {
    for (std::size_t i = 0; i < steps(); ++i) {
        const Piece piece = piece_at(static_cast<int>(i));
        pieces.insert(pieces.end(), {piece.a, piece.b, piece.c, piece.d});
    }
}

RisingCurve::RisingCurve(RadialCurve curve) : curve_(std::move(curve)) {
    const std::size_t steps = curve_.steps();
    const double end = curve_.at(curve_.end()).value;
    std::vector<RadialCurve::At> nodes;
    for (std::size_t i = 0; i <= steps; ++i) {
        const Place place = searched(i == steps ? end : end * static_cast<double>(i) / static_cast<double>(steps));
        nodes.push_back({place.x, 1.0 / place.slope});
    }
    inverse_ = {end, nodes};
}

bool RisingCurve::is_found_in_a_step() const {
    const auto looks = static_cast<int>(8 * inverse_.steps());
    for (int i = 0; i <= looks; ++i) {
        if (!step_to(inverse_.end() * i / looks).is_small) {
            return false;
        }
    }
    return true;
}

/// By halving, and what is left by Newton's steps.
RisingCurve::Place RisingCurve::searched(double value) const {
    constexpr int kHalvings = 20;
    double x = bisected({0.0, curve_.end()}, kHalvings, [&](double at) { return curve_.at(at).value <= value; }).inside;
    constexpr int kMostSteps = 8;
    for (int step = 0; step < kMostSteps; ++step) {
        const RadialCurve::At here = curve_.at(x);
        const double next = std::clamp(x - (here.value - value) / here.slope, 0.0, curve_.end());
        if (next == x) {
            break;
        }
        x = next;
    }
    return {x, curve_.at(x).slope};
}

void RadialCurve::append_to(std::string& bytes) const {
    append_bytes(bytes, end_, static_cast<std::uint32_t>(nodes_.size()));
    for (const At& node : nodes_) {
        append_bytes(bytes, node.value, node.slope);
    }
}

std::optional<RadialCurve> RadialCurve::taken_from(std::string_view& bytes) {
    const auto end = take_bytes<double>(bytes);
    const auto count = take_bytes<std::uint32_t>(bytes);
    if (!end || !(*end >= 0.0) || !std::isfinite(*end) || !count || *count < 2 || *count > bytes.size()) {
        return std::nullopt;
    }
    RadialCurve curve(*end, std::vector<At>(*count));
    for (At& node : curve.nodes_) {
        const auto value = take_bytes<double>(bytes);
        const auto slope = take_bytes<double>(bytes);
        if (!value || !slope || !std::isfinite(*value) || !std::isfinite(*slope)) {
            return std::nullopt;
        }
        node = {*value, *slope};
    }
    return curve;
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
