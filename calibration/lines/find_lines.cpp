#include "calibration/lines/find_lines.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <optional>
#include <utility>

#include "calibration/detection/line_segments.h"
#include "calibration/detection/working_copy.h"
#include "calibration/lines/line_chains.h"
#include "calibration/lines/trace_line.h"

namespace lensproof::calibration {
namespace {

constexpr double kMostShared = 0.3;  // of a line's points, which another line has too

// Turned so that the bright side is on the right of its way (y downwards, on the left).
LineSegment bright_side_first(const cv::Mat& plane, const LineSegment& segment, double scale) {
    const Vec2d u = direction_of(segment);
    const Vec2d across{u.y, -u.x};
    double difference = 0.0;
    constexpr int kLooks = 16;
    for (int i = 1; i < kLooks; ++i) {
        const Vec2d at = segment.from + (static_cast<double>(i) / kLooks) * (segment.to - segment.from);
        difference += light_at(plane, at + (1.5 * scale) * across) - light_at(plane, at - (1.5 * scale) * across);
    }
    return difference >= 0.0 ? segment : LineSegment{segment.to, segment.from};
}

// The places where lines of one way have points, to two pixels: the other side of a thin bar goes the other way.
class Taken {
  public:
    [[nodiscard]] bool holds(const Vec2d& p, const Vec2d& direction) const {
        const auto [x, y] = cell(p);
        for (int dx = -1; dx <= 1; ++dx) {
            for (int dy = -1; dy <= 1; ++dy) {
                const auto known = directions_.find({x + dx, y + dy});
                if (known != directions_.end() && known->second.x * direction.x + known->second.y * direction.y > 0.0) {
                    return true;
                }
            }
        }
        return false;
    }
    void add(const Vec2d& p, const Vec2d& direction) { directions_.emplace(cell(p), direction); }

  private:
    static std::pair<int, int> cell(const Vec2d& p) {
        return {static_cast<int>(std::lround(p.x)), static_cast<int>(std::lround(p.y))};
    }
    std::map<std::pair<int, int>, Vec2d> directions_;
};

// Longest first; a line that has a longer one's points is the same edge, found twice.
std::vector<SceneLine> each_once(std::vector<SceneLine> lines) {
    std::ranges::stable_sort(lines, std::greater<>(), chord_px);
    Taken taken;
    std::vector<SceneLine> kept;
    for (SceneLine& line : lines) {
        const Vec2d direction = line.points_px.back() - line.points_px.front();
        const auto shared =
            std::ranges::count_if(line.points_px, [&](const Vec2d& p) { return taken.holds(p, direction); });
        if (static_cast<double>(shared) > kMostShared * static_cast<double>(line.points_px.size())) {
            continue;
        }
        for (std::size_t i = 0; i < line.points_px.size(); ++i) {
            taken.add(line.points_px[i], direction);
            if (i > 0) {
                taken.add(0.5 * (line.points_px[i] + line.points_px[i - 1]), direction);
            }
        }
        kept.push_back(std::move(line));
    }
    return kept;
}

}  // namespace

std::vector<SceneLine> find_lines(const formats::Image& image, int channel, const std::string& name) {
    const cv::Mat plane = channel_plane(image, channel);
    FoundSegments found = find_segments(image);
    for (LineSegment& segment : found.segments) {
        segment = bright_side_first(plane, segment, found.scale);
    }
    const double shortest = kShortestLine * std::hypot(image.width, image.height);
    std::vector<SceneLine> lines;
    for (const LineChain& chain : joined_segments(std::move(found.segments), found.scale)) {
        if (chord_of(chain) < 0.9 * shortest) {
            continue;
        }
        if (auto line = trace_line(plane, chain, found.scale); line && chord_px(*line) >= shortest) {
            line->image = name;
            lines.push_back(std::move(*line));
        }
    }
    return each_once(std::move(lines));
}

}  // namespace lensproof::calibration
