#include "experiments/draw/clipping.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

namespace lensproof::draw {

namespace {

SvgPoint between(SvgPoint a, SvgPoint b, double t) {
    return {a.x + t * (b.x - a.x), a.y + t * (b.y - a.y)};
}

/// Liang & Barsky (1984): the segment's part inside the box as its parameters, 0 at a and 1 at b.
std::optional<std::pair<double, double>> inside_part(SvgPoint a, SvgPoint b, const PageBox& box) {
    double enter = 0.0;
    double leave = 1.0;
    const auto cut = [&](double step, double room) {  // inside where t * step <= room
        if (step == 0.0) {
            return room >= 0.0;
        }
        const double t = room / step;
        (step < 0.0 ? enter : leave) = step < 0.0 ? std::max(enter, t) : std::min(leave, t);
        return enter <= leave;
    };
    const bool crosses = cut(a.x - b.x, a.x - box.x) && cut(b.x - a.x, box.x + box.width - a.x) &&
                         cut(a.y - b.y, a.y - box.y) && cut(b.y - a.y, box.y + box.height - a.y);
    return crosses ? std::optional(std::pair(enter, leave)) : std::nullopt;
}

/// Adds the segment's part inside; a segment that enters starts a new piece.
void add_segment(std::vector<std::vector<SvgPoint>>& pieces, SvgPoint a, SvgPoint b, const PageBox& box,
                 bool& continues) {
    const auto part = inside_part(a, b, box);
    if (!part) {
        continues = false;
        return;
    }
    if (!continues || part->first > 0.0) {
        pieces.push_back({part->first > 0.0 ? between(a, b, part->first) : a});
    }
    pieces.back().push_back(part->second < 1.0 ? between(a, b, part->second) : b);
    continues = part->second >= 1.0;
}

}  // namespace

bool is_inside(const PageBox& box, SvgPoint point) {
    return point.x >= box.x && point.x <= box.x + box.width && point.y >= box.y && point.y <= box.y + box.height;
}

std::vector<std::vector<SvgPoint>> clipped_line(const std::vector<SvgPoint>& points, const PageBox& box) {
    std::vector<std::vector<SvgPoint>> pieces;
    bool continues = false;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (!is_finite(points[i])) {
            continues = false;
            continue;
        }
        const bool has_before = i > 0 && is_finite(points[i - 1]);
        const bool has_after = i + 1 < points.size() && is_finite(points[i + 1]);
        if (has_after) {
            add_segment(pieces, points[i], points[i + 1], box, continues);
        } else if (!has_before && is_inside(box, points[i])) {
            pieces.push_back({points[i]});
        }
    }
    return pieces;
}

std::vector<std::vector<SvgPoint>> hatching(const std::vector<std::vector<SvgPoint>>& outlines, double step,
                                            double start) {
    std::map<double, std::vector<SvgPoint>> crossings;  // by the line's number
    for (const std::vector<SvgPoint>& outline : outlines) {
        for (std::size_t i = 0; i < outline.size(); ++i) {
            SvgPoint a = outline[i];
            SvgPoint b = outline[(i + 1) % outline.size()];
            if (a.x + a.y > b.x + b.y) {
                std::swap(a, b);
            }
            const double low = (a.x + a.y - start) / step;
            const double high = (b.x + b.y - start) / step;
            for (double line = std::ceil(low); line < high; line += 1.0) {
                crossings[line].push_back(between(a, b, (line - low) / (high - low)));
            }
        }
    }
    std::vector<std::vector<SvgPoint>> pieces;
    for (auto& [line, points] : crossings) {
        std::ranges::sort(points, {}, &SvgPoint::x);
        for (std::size_t i = 0; i + 1 < points.size(); i += 2) {
            if (points[i].x < points[i + 1].x) {
                pieces.push_back({points[i], points[i + 1]});
            }
        }
    }
    return pieces;
}

std::vector<SvgPoint> clipped_polygon(const std::vector<SvgPoint>& points, const PageBox& box) {
    std::vector<SvgPoint> kept;
    std::ranges::copy_if(points, std::back_inserter(kept), [](SvgPoint point) { return is_finite(point); });
    // Against each edge: the signed distance to its inner side.
    const auto cut = [&](auto inside_by) {
        std::vector<SvgPoint> next;
        for (std::size_t i = 0; i < kept.size(); ++i) {
            const SvgPoint a = kept[i];
            const SvgPoint b = kept[(i + 1) % kept.size()];
            const double at_a = inside_by(a);
            const double at_b = inside_by(b);
            if (at_a >= 0.0) {
                next.push_back(a);
            }
            if ((at_a >= 0.0) != (at_b >= 0.0)) {
                next.push_back(between(a, b, at_a / (at_a - at_b)));
            }
        }
        kept = std::move(next);
    };
    cut([&](SvgPoint p) { return p.x - box.x; });
    cut([&](SvgPoint p) { return box.x + box.width - p.x; });
    cut([&](SvgPoint p) { return p.y - box.y; });
    cut([&](SvgPoint p) { return box.y + box.height - p.y; });
    return kept;
}

}  // namespace lensproof::draw
