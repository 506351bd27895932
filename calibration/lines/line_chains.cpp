#include "calibration/lines/line_chains.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>

namespace lensproof::calibration {
namespace {

constexpr double kMostTurn_rad = 0.15;
constexpr double kLeastGap_px = 10.0;  // is bridged whatever the length, in pixels of the search
constexpr double kMostOverlap_px = 6.0;
constexpr double kGapOfLength = 1.3;     // of the shorter neighbour
constexpr double kOffCircle_px = 1.5;    // in pixels of the search,
constexpr double kOffCirclePart = 0.02;  // and of the gap
constexpr double kSmallPart_px = 7.0;    // shorter segments have no direction to speak of

double cross_of(const Vec2d& a, const Vec2d& b) {
    return a.x * b.y - a.y * b.x;
}

// How badly `b` goes on where `a` ends; none where it does not.
std::optional<double> cost_of_joining(const LineSegment& a, const LineSegment& b, double scale) {
    const Vec2d u = direction_of(a);
    const Vec2d v = direction_of(b);
    const double turn = std::atan2(cross_of(u, v), dot(u, v));
    if (std::abs(turn) > kMostTurn_rad) {
        return std::nullopt;
    }
    const Vec2d gap = b.from - a.to;
    const Vec2d both = u + v;
    const double size = std::hypot(both.x, both.y);
    const Vec2d mean{both.x / size, both.y / size};
    const double along = dot(gap, mean);
    const double longest = std::max(kLeastGap_px * scale, kGapOfLength * std::min(length_of(a), length_of(b)));
    if (along < -kMostOverlap_px * scale || along > longest) {
        return std::nullopt;
    }
    // A chord of a circle lies along the mean of its tangents; a tangent is that of its segment's middle.
    const Vec2d middles = 0.5 * (b.from + b.to) - 0.5 * (a.from + a.to);
    const double off = std::max(std::abs(cross_of(mean, gap)) - kOffCirclePart * std::max(along, 0.0),
                                std::abs(cross_of(mean, middles)) - kOffCirclePart * std::abs(dot(mean, middles)));
    if (off > kOffCircle_px * scale) {
        return std::nullopt;
    }
    return std::abs(along) + 10.0 * std::max(off, 0.0);
}

std::optional<std::size_t> best_join(const std::vector<LineSegment>& segments, const std::vector<bool>& taken,
                                     const std::function<std::optional<double>(const LineSegment&)>& cost_of) {
    std::optional<std::size_t> best;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < segments.size(); ++i) {
        if (taken[i]) {
            continue;
        }
        if (const auto cost = cost_of(segments[i]); cost && *cost < least) {
            least = *cost;
            best = i;
        }
    }
    return best;
}

}  // namespace

double chord_of(const LineChain& chain) {
    return length_of({chain.front().from, chain.back().to});
}

std::vector<LineChain> joined_segments(std::vector<LineSegment> segments, double scale) {
    std::erase_if(segments, [&](const LineSegment& s) { return length_of(s) < kSmallPart_px * scale; });
    std::ranges::stable_sort(segments, std::greater<>(), length_of);
    std::vector<bool> taken(segments.size(), false);
    std::vector<LineChain> chains;
    for (std::size_t i = 0; i < segments.size(); ++i) {
        if (taken[i]) {
            continue;
        }
        taken[i] = true;
        LineChain chain{segments[i]};
        while (const auto next = best_join(
                   segments, taken, [&](const LineSegment& s) { return cost_of_joining(chain.back(), s, scale); })) {
            taken[*next] = true;
            chain.push_back(segments[*next]);
        }
        while (const auto before = best_join(
                   segments, taken, [&](const LineSegment& s) { return cost_of_joining(s, chain.front(), scale); })) {
            taken[*before] = true;
            chain.insert(chain.begin(), segments[*before]);
        }
        chains.push_back(std::move(chain));
    }
    return chains;
}

}  // namespace lensproof::calibration
