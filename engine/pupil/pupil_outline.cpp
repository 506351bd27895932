#include "engine/pupil/pupil_outline.h"

#include <algorithm>
#include <cmath>

#include "engine/base/angle.h"
#include "engine/pupil/polygon.h"

namespace lensproof::pupil {

namespace {

constexpr double kPrecision = 1e-4;       // of an edge's distance
constexpr double kCornerFraction = 5e-5;  // of the region's area: what a corner may hide
constexpr int kCornerRounds = 8;
constexpr int kCoarseAzimuths = 16;  // over the half plane x ≥ 0
constexpr int kFineAzimuths = 48;
constexpr int kFineAzimuthsOfWhole = 32;  // where there is no mirror image to be spared
constexpr int kGrid = 32;

/// A ray from a region's centre, in its frame, and where it leaves the region: between `inside` and `outside`, which
/// are first guessed.
struct EdgeRay {
    double azimuth = 0.0;
    double inside = 0.0;
    double outside = 0.0;

    [[nodiscard]] Vec2d at(double distance) const {
        return {distance * std::cos(azimuth), distance * std::sin(azimuth)};
    }
};

/// A region that is being outlined.
struct Found {
    int region = 0;
    PupilFrame frame;
    bool is_settled = false;    // the frame is a good one
    std::vector<EdgeRay> rays;  // by rising azimuth
};

class OutlineFinder {
  public:
    OutlineFinder(const PassTest& passes, const OutlineSearch& search)
        : passes_(passes), search_(search), is_mirror_(search.symmetry == PupilSymmetry::mirror) {}

    std::vector<PupilOutline> find(std::span<const std::optional<PupilFrame>> expected) {
        find_frames(expected);
        constexpr int kSettlingRounds = 3;
        for (int round = 0; round < kSettlingRounds; ++round) {
            settle();
        }
        std::vector<Found*> all;
        for (Found& found : found_) {
            all.push_back(&found);
        }
        spread_rays(all, is_mirror_ ? kFineAzimuths : kFineAzimuthsOfWhole, 0.8, 1.25);
        for (int round = 0; round < kCornerRounds && look_at_corners(); ++round) {
        }
        std::vector<PupilOutline> outlines(expected.size());
        for (const Found& found : found_) {
            outlines[found.region] = {settled_frame(found), closed_outline(found)};
        }
        return outlines;
    }

  private:
    /// Asks all points at once.
    const std::vector<std::uint8_t>& ask(const std::vector<RegionPoint>& points) {
        answers_.assign(points.size(), 0);
        passes_(points, answers_);
        return answers_;
    }

    // --- Where the regions are ---

    void find_frames(std::span<const std::optional<PupilFrame>> expected) {
        std::vector<std::pair<int, PupilFrame>> boxes;  // to look for a region in
        std::vector<RegionPoint> centres;
        for (int i = 0; i < static_cast<int>(expected.size()); ++i) {
            if (expected[i]) {
                centres.push_back({i, expected[i]->centre});
            } else {
                boxes.emplace_back(i, whole_disc());
            }
        }
        const std::vector<std::uint8_t>& inside = ask(centres);
        for (std::size_t i = 0; i < centres.size(); ++i) {
            const int region = centres[i].region;
            if (inside[i] != 0) {
                found_.push_back({.region = region, .frame = *expected[region], .is_settled = true, .rays = {}});
            } else {
                boxes.emplace_back(region, *expected[region]);
            }
        }
        std::ranges::sort(boxes, {}, [](const auto& box) { return box.first; });
        look_in(boxes);
        std::ranges::sort(found_, {}, &Found::region);
    }

    [[nodiscard]] PupilFrame whole_disc() const { return {.centre = {}, .scale = {search_.radius, search_.radius}}; }

    /// Adds the regions that a grid over their boxes meets, or that `look_closer` finds.
    void look_in(const std::vector<std::pair<int, PupilFrame>>& boxes) {
        constexpr double kMargin = 1.2;
        std::vector<RegionPoint> grid;
        const int first_column = is_mirror_ ? kGrid / 2 : 0;
        for (const auto& [region, box] : boxes) {
            for (int i = first_column; i < kGrid; ++i) {
                for (int k = 0; k < kGrid; ++k) {
                    grid.push_back({region, box.from_own({kMargin * ((2.0 * i + 1.0) / kGrid - 1.0),
                                                          kMargin * ((2.0 * k + 1.0) / kGrid - 1.0)})});
                }
            }
        }
        const std::vector<std::uint8_t>& inside = ask(grid);
        const std::size_t points_per_box = static_cast<std::size_t>(kGrid - first_column) * kGrid;
        std::vector<PupilFrame> frames;
        std::vector<RegionPoint> centres;
        for (std::size_t b = 0; b < boxes.size(); ++b) {
            std::vector<Vec2d> hits;
            for (std::size_t i = b * points_per_box; i < (b + 1) * points_per_box; ++i) {
                if (inside[i] != 0) {
                    hits.push_back(grid[i].point);
                }
            }
            const auto& [region, box] = boxes[b];
            const Vec2d cell = 2.0 * kMargin * box.scale / (1.0 * kGrid);
            frames.push_back(hits.empty() ? PupilFrame{.centre = {}, .scale = cell} : frame_of(hits, cell));
            centres.push_back({region, frames.back().centre});
        }
        add_around_centres(centres, frames);
    }

    /// Adds regions by frames whose centres lie inside. Where one does not, as between the ends of a bent strip, the
    /// closer look may find another.
    void add_around_centres(const std::vector<RegionPoint>& centres, std::vector<PupilFrame>& frames) {
        const std::vector<std::uint8_t>& inside = ask(centres);
        for (std::size_t i = 0; i < centres.size(); ++i) {
            const int region = centres[i].region;
            std::optional<Vec2d> centre;
            if (inside[i] != 0) {
                centre = centres[i].point;
            } else if (search_.look_closer) {
                centre = search_.look_closer(region);
            }
            if (centre) {
                frames[i].centre = *centre;
                found_.push_back({.region = region, .frame = frames[i], .is_settled = false, .rays = {}});
            }
        }
    }

    /// Around the point of `hits` that is nearest to their mean (of a mirror image, of those nearest to x = 0).
    [[nodiscard]] PupilFrame frame_of(const std::vector<Vec2d>& hits, Vec2d cell) const {
        Vec2d lower = hits.front();
        Vec2d upper = hits.front();
        Vec2d mean{};
        for (const Vec2d& hit : hits) {
            lower = {std::min(lower.x, hit.x), std::min(lower.y, hit.y)};
            upper = {std::max(upper.x, hit.x), std::max(upper.y, hit.y)};
            mean = mean + hit / static_cast<double>(hits.size());
        }
        if (is_mirror_) {
            mean.x = 0.0;
        }
        const auto distance = [&](Vec2d hit) {
            return std::hypot((hit.x - mean.x) / cell.x, (hit.y - mean.y) / cell.y);
        };
        Vec2d centre = *std::ranges::min_element(hits, {}, distance);
        if (is_mirror_) {
            centre.x = 0.0;
            lower.x = -upper.x;
        }
        return {.centre = centre, .scale = 0.5 * (upper - lower + cell), .bend = 0.0};
    }

    /// Centres, scales and bends the frames by a coarse outline.
    void settle() {
        std::vector<Found*> unsettled;
        for (Found& found : found_) {
            if (!found.is_settled) {
                unsettled.push_back(&found);
            }
        }
        spread_rays(unsettled, kCoarseAzimuths, 0.5, 2.0);
        std::vector<PupilFrame> better;
        std::vector<RegionPoint> centres;
        for (const Found* found : unsettled) {
            better.push_back(settled_frame(*found));
            centres.push_back({found->region, better.back().centre});
        }
        const std::vector<std::uint8_t>& inside = ask(centres);
        for (std::size_t i = 0; i < unsettled.size(); ++i) {
            if (inside[i] != 0) {
                unsettled[i]->frame = better[i];
            } else {
                unsettled[i]->frame.scale = better[i].scale;
            }
        }
    }

    [[nodiscard]] PupilFrame settled_frame(const Found& found) const {
        std::vector<Vec2d> polygon;
        Vec2d lower{};
        Vec2d upper{};
        for (const EdgeRay& ray : found.rays) {
            const Vec2d at = ray.at(ray.outside);
            polygon.push_back(at);
            lower = {std::min(lower.x, at.x), std::min(lower.y, at.y)};
            upper = {std::max(upper.x, at.x), std::max(upper.y, at.y)};
        }
        if (is_mirror_) {
            lower.x = -upper.x;
            polygon.front().x = 0.0;  // which cosines of ±π/2 miss
            polygon.back().x = 0.0;
        }
        const Vec2d half = 0.5 * (upper - lower);
        const double middle_x = is_mirror_ ? 0.0 : 0.5 * (lower.x + upper.x);
        const auto middle_at = [&](double x) {
            const std::optional<Span> span = span_at(polygon, x);
            return span ? 0.5 * (span->lower + span->upper) : 0.0;
        };
        constexpr double kOut = 0.7;
        const double right = middle_at(middle_x + kOut * half.x);
        const double left = is_mirror_ ? right : middle_at(middle_x - kOut * half.x);
        const double middle = middle_at(middle_x);
        PupilFrame frame = found.frame;
        frame.centre = found.frame.from_own({middle_x, middle});
        const double reach = kOut * half.x * found.frame.scale.x;
        frame.bend += found.frame.scale.y * (0.5 * (left + right) - middle) / (reach * reach);
        frame.scale = {half.x * found.frame.scale.x, half.y * found.frame.scale.y};
        return frame;
    }

    // --- Their edges ---

    /// Gives every region `count` rays a half turn, evenly spread, with their edges; these are expected between
    /// `inside` and `outside`.
    void spread_rays(const std::vector<Found*>& all, int count, double inside, double outside) {
        std::vector<std::pair<Found*, EdgeRay*>> edges;
        for (Found* found : all) {
            const int rays = is_mirror_ ? count + 1 : 2 * count;
            found->rays.clear();
            for (int i = 0; i < rays; ++i) {
                found->rays.push_back({.azimuth = kPi * i / count - 0.5 * kPi, .inside = inside, .outside = outside});
            }
            for (EdgeRay& ray : found->rays) {
                edges.emplace_back(found, &ray);
            }
        }
        find_edges(edges);
    }

    /// The distance at which a ray has left the disc.
    [[nodiscard]] double limit(const PupilFrame& frame, const EdgeRay& ray, double from) const {
        double distance = from;
        constexpr double kFar = 1e12;  // seventy doublings from a nanometre
        while (distance < kFar) {
            const Vec2d at = frame.from_own(ray.at(distance));
            if (dot(at, at) > search_.radius * search_.radius) {
                break;
            }
            distance *= 2.0;
        }
        return distance;
    }

    /// Makes the guesses right: `inside` inside, `outside` outside.
    void check_guesses(const std::vector<std::pair<Found*, EdgeRay*>>& edges) {
        std::vector<RegionPoint> points;
        for (const auto& [found, ray] : edges) {
            points.push_back({found->region, found->frame.from_own(ray->at(ray->inside))});
            points.push_back({found->region, found->frame.from_own(ray->at(ray->outside))});
        }
        const std::vector<std::uint8_t>& inside = ask(points);
        for (std::size_t i = 0; i < edges.size(); ++i) {
            EdgeRay& ray = *edges[i].second;
            if (inside[2 * i] == 0) {
                ray.outside = ray.inside;
                ray.inside = 0.0;
            } else if (inside[2 * i + 1] != 0) {
                ray.inside = ray.outside;
                ray.outside = limit(edges[i].first->frame, ray, 2.0 * ray.inside);
            }
        }
    }

    void find_edges(std::vector<std::pair<Found*, EdgeRay*>> edges) {
        check_guesses(edges);
        std::vector<RegionPoint> points;
        const auto is_found = [](const std::pair<Found*, EdgeRay*>& edge) {
            constexpr double kNothing = 1e-9;
            return edge.second->outside - edge.second->inside <= kPrecision * edge.second->outside + kNothing;
        };
        std::erase_if(edges, is_found);
        while (!edges.empty()) {
            points.clear();
            for (const auto& [found, ray] : edges) {
                points.push_back({found->region, found->frame.from_own(ray->at(0.5 * (ray->inside + ray->outside)))});
            }
            const std::vector<std::uint8_t>& inside = ask(points);
            for (std::size_t i = 0; i < edges.size(); ++i) {
                EdgeRay& ray = *edges[i].second;
                (inside[i] != 0 ? ray.inside : ray.outside) = 0.5 * (ray.inside + ray.outside);
            }
            std::erase_if(edges, is_found);
        }
    }

    // --- Their corners ---

    [[nodiscard]] std::vector<Vec2d> edge_points(const Found& found) const {
        std::vector<Vec2d> points;
        for (const EdgeRay& ray : found.rays) {
            points.push_back(found.frame.from_own(ray.at(ray.outside)));
        }
        if (is_mirror_) {  // which cosines of ±π/2 miss
            points.front().x = found.frame.centre.x;
            points.back().x = found.frame.centre.x;
        }
        return points;
    }

    /// The triangle over the side from point `i` to the next one.
    [[nodiscard]] Apex apex(const std::vector<Vec2d>& points, std::size_t i) const {
        const std::size_t count = points.size();
        const auto mirrored = [](Vec2d p) { return Vec2d{-p.x, p.y}; };
        const Vec2d before = i > 0 ? points[i - 1] : (is_mirror_ ? mirrored(points[1]) : points[count - 1]);
        const Vec2d after =
            i + 2 < count ? points[i + 2] : (is_mirror_ ? mirrored(points[count - 2]) : points[(i + 2) % count]);
        return apex_over(before, points[i], points[(i + 1) % count], after);
    }

    [[nodiscard]] std::size_t sides(const Found& found) const { return found.rays.size() - (is_mirror_ ? 1 : 0); }

    /// Adds rays where a corner may hide too much; whether there are any such.
    bool look_at_corners() {
        std::vector<std::pair<Found*, EdgeRay*>> edges;
        for (Found& found : found_) {
            const std::vector<Vec2d> points = edge_points(found);
            double twice_area = 0.0;
            for (std::size_t i = 0; i < sides(found); ++i) {
                twice_area +=
                    cross(points[i] - found.frame.centre, points[(i + 1) % points.size()] - found.frame.centre);
            }
            std::vector<EdgeRay> rays;
            std::vector<std::size_t> added;
            for (std::size_t i = 0; i < found.rays.size(); ++i) {
                rays.push_back(found.rays[i]);
                if (i < sides(found) && apex(points, i).area > 0.5 * kCornerFraction * twice_area) {
                    const EdgeRay& next = found.rays[(i + 1) % found.rays.size()];
                    const double turn = next.azimuth - rays.back().azimuth;
                    const auto [nearer, farther] = std::minmax(found.rays[i].outside, next.outside);
                    added.push_back(rays.size());
                    rays.push_back({.azimuth = found.rays[i].azimuth + 0.5 * (turn < 0.0 ? turn + 2.0 * kPi : turn),
                                    .inside = 0.9 * nearer,
                                    .outside = 1.1 * farther});
                }
            }
            found.rays = std::move(rays);
            for (const std::size_t i : added) {
                edges.emplace_back(&found, &found.rays[i]);
            }
        }
        find_edges(edges);
        return !edges.empty();
    }

    [[nodiscard]] std::vector<Vec2d> closed_outline(const Found& found) const {
        const std::vector<Vec2d> points = edge_points(found);
        std::vector<Vec2d> closed;
        for (std::size_t i = 0; i < points.size(); ++i) {
            closed.push_back(points[i]);
            if (i < sides(found)) {
                const Apex over = apex(points, i);
                if (over.exists) {
                    closed.push_back({is_mirror_ ? std::max(0.0, over.point.x) : over.point.x, over.point.y});
                }
            }
        }
        return closed;
    }

    const PassTest& passes_;
    const OutlineSearch& search_;
    bool is_mirror_;
    std::vector<Found> found_;
    std::vector<std::uint8_t> answers_;
};

}  // namespace

std::vector<PupilOutline> pupil_outlines(const PassTest& passes, std::span<const std::optional<PupilFrame>> expected,
                                         const OutlineSearch& search) {
    return OutlineFinder(passes, search).find(expected);
}

}  // namespace lensproof::pupil
