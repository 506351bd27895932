#include "engine/analysis/ghost_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>
#include <unordered_map>
#include <unordered_set>

#include "engine/base/infinity.h"

namespace lensproof::analysis {

namespace {

constexpr int kDivisions = 7;            // of a first cell, at most
constexpr int kUnits = 2 << kDivisions;  // of the lattice of corners along a first cell: the smallest has middles
constexpr std::size_t kFirstCells = 40;  // about so many, or up to four times as many
constexpr std::size_t kMostLeaves = 40000;
constexpr int kMostGrowth = 64;  // rings of first cells
constexpr int kCuts = 4;         // rays to find where a side meets a rim

struct Place {
    int x;
    int y;
};

struct Vertex {
    Place place;
    RimRay ray;

    [[nodiscard]] bool lands() const { return ray.arrives && ray.margin <= 0.0; }
};

struct Cell {
    Place corner;  // the low one
    int size;
};

/// A corner of a triangle: where it stands on the front, in units, and where its light lands.
struct Corner {
    Vec2d front;
    RimRay ray;
};

class Mesh {
  public:
    Mesh(const GhostScene& scene, const optics::GhostPath& path, const GhostRegion& region,
         const MeshSettings& settings)
        : scene_(scene), path_(path), settings_(settings), corner_(region.corner) {
        std::vector<Place> firsts;
        for (const auto& [x, y] : region.cells) {
            firsts.push_back({x, y});
        }
        double side = region.cell;
        while (firsts.size() > kFirstCells) {
            for (Place& cell : firsts) {
                cell = {cell.x >> 1, cell.y >> 1};
            }
            side *= 2.0;
            const auto before = [](const Place& a, const Place& b) { return std::tie(a.y, a.x) < std::tie(b.y, b.x); };
            const auto same = [](const Place& a, const Place& b) { return a.x == b.x && a.y == b.y; };
            std::ranges::sort(firsts, before);
            firsts.erase(std::unique(firsts.begin(), firsts.end(), same), firsts.end());
        }
        unit_ = side / kUnits;
        for (const Place& cell : firsts) {
            add_first(cell);
        }
    }

    MeshedGhost draw(const DrawTriangle& draw) {
        grow();
        refine();
        for (const Cell& cell : cells_) {
            for (const auto& triangle : triangles_of(cell)) {
                note_cuts(triangle);
            }
        }
        cut();
        for (const Cell& cell : cells_) {
            for (const auto& triangle : triangles_of(cell)) {
                draw_lit(triangle, draw);
            }
        }
        return drawn_;
    }

  private:
    using Triangle = std::array<std::size_t, 3>;

    // --- rays

    [[nodiscard]] Vec2d offset(Vec2d front) const { return corner_ + unit_ * front; }
    static Vec2d front(const Place& place) { return {static_cast<double>(place.x), static_cast<double>(place.y)}; }

    void want(int x, int y) {
        if (at_.emplace(GhostRegion::key(x, y), vertices_.size()).second) {
            vertices_.push_back({.place = {x, y}, .ray = {}});
        }
    }
    void want(const Cell& cell) {
        const int half = cell.size / 2;
        for (int j = 0; j < 3; ++j) {
            for (int i = 0; i < 3; ++i) {
                want(cell.corner.x + i * half, cell.corner.y + j * half);
            }
        }
    }
    void trace_wanted() {
        offsets_.clear();
        for (std::size_t i = traced_; i < vertices_.size(); ++i) {
            offsets_.push_back(offset(front(vertices_[i].place)));
        }
        trace(offsets_);
        for (std::size_t i = traced_; i < vertices_.size(); ++i) {
            vertices_[i].ray = rays_[i - traced_];
        }
        traced_ = vertices_.size();
    }
    void trace(const std::vector<Vec2d>& offsets) {
        rays_ = rim_rays(scene_, path_, offsets);
        drawn_.rays += static_cast<int>(offsets.size());
    }

    [[nodiscard]] std::size_t index(int x, int y) const { return at_.at(GhostRegion::key(x, y)); }
    /// Of a cell's nine, row by row.
    [[nodiscard]] std::array<const Vertex*, 9> nine(const Cell& cell) const {
        std::array<const Vertex*, 9> nine{};
        const int half = cell.size / 2;
        for (int i = 0; i < 9; ++i) {
            nine[static_cast<std::size_t>(i)] =
                &vertices_[index(cell.corner.x + i % 3 * half, cell.corner.y + i / 3 * half)];
        }
        return nine;
    }

    // --- cells

    void add_first(const Place& cell) {
        if (firsts_.insert(GhostRegion::key(cell.x, cell.y)).second) {
            cells_.push_back({.corner = {cell.x * kUnits, cell.y * kUnits}, .size = kUnits});
            want(cells_.back());
        }
    }

    /// Beside a side on which light lands there has to be a cell.
    void grow() {
        trace_wanted();
        constexpr std::array<std::array<int, 5>, 4> kSides{
            {{0, 1, 2, 0, -1}, {6, 7, 8, 0, 1}, {0, 3, 6, -1, 0}, {2, 5, 8, 1, 0}}};
        std::size_t first = 0;
        for (int ring = 0; ring < kMostGrowth && first < cells_.size(); ++ring) {
            const std::size_t end = cells_.size();
            for (std::size_t i = first; i < end; ++i) {
                const Place at{cells_[i].corner.x / kUnits, cells_[i].corner.y / kUnits};
                for (const auto& [a, b, c, dx, dy] : kSides) {
                    const auto vertices = nine(cells_[i]);
                    if (vertices[a]->lands() || vertices[b]->lands() || vertices[c]->lands()) {
                        add_first({at.x + dx, at.y + dy});
                    }
                }
            }
            trace_wanted();
            first = end;
        }
    }

    /// What of a cell's light is not known, and whether it lands where it would have to be divided for.
    struct Doubt {
        double lit = 0.0;        // fraction of it that lands, about
        double energy = 0.0;     // what lands, in units² of the front
        double rim_error = 0.0;  // likewise
        bool is_bent = false;
    };

    [[nodiscard]] Doubt doubt(const Cell& cell) const {
        const auto nine = this->nine(cell);
        double lit = 0.0;
        double transmitted = 0.0;
        double least = kInfinity;
        double most = -kInfinity;
        bool all_arrive = true;
        for (const Vertex* vertex : nine) {
            lit += vertex->lands() ? 1.0 : 0.0;
            transmitted += vertex->lands() ? vertex->ray.transmittance : 0.0;
            all_arrive = all_arrive && vertex->ray.arrives;
            least = std::min(least, vertex->ray.margin);
            most = std::max(most, vertex->ray.margin);
        }
        const double area = static_cast<double>(cell.size) * cell.size;
        Doubt doubt{.lit = lit / 9.0, .energy = area * transmitted / 9.0};
        if (lit == 0.0) {
            return doubt;
        }
        constexpr std::array<std::array<std::size_t, 3>, 8> kLines{
            {{0, 1, 2}, {3, 4, 5}, {6, 7, 8}, {0, 3, 6}, {1, 4, 7}, {2, 5, 8}, {0, 4, 8}, {2, 4, 6}}};
        double bulge = 0.0;  // of margins
        for (const auto& [a, middle, b] : kLines) {
            const std::array<const Vertex*, 3> on{nine[a], nine[middle], nine[b]};
            const bool is_lit = on[0]->lands() || on[1]->lands() || on[2]->lands();
            if (is_lit && on[0]->ray.arrives && on[1]->ray.arrives && on[2]->ray.arrives) {
                const Vec2d off = on[1]->ray.point - 0.5 * (on[0]->ray.point + on[2]->ray.point);
                doubt.is_bent = doubt.is_bent || length(off) > 4.0 * settings_.place_error;
            }
            bulge = std::max(bulge, std::abs(on[1]->ray.margin - 0.5 * (on[0]->ray.margin + on[2]->ray.margin)));
        }
        if (lit < 9.0) {
            // Chords of half the cell's size leave a quarter of the bulge, and of that two thirds on average.
            const double slope = (most - least) / cell.size;
            const double width =
                all_arrive && slope > 0.0 ? std::min(0.25 * bulge / slope, 0.5 * cell.size) : 0.25 * cell.size;
            doubt.rim_error = 2.0 / 3.0 * width * cell.size * (transmitted / lit);
        }
        return doubt;
    }

    void refine() {
        std::vector<Doubt> doubts;
        for (int division = 0; division <= kDivisions; ++division) {
            doubts.clear();
            double energy = 0.0;
            double error = 0.0;
            int at_rims = 0;
            for (const Cell& cell : cells_) {
                doubts.push_back(doubt(cell));
                energy += doubts.back().energy;
                error += doubts.back().rim_error;
                at_rims += doubts.back().rim_error > 0.0 ? 1 : 0;
            }
            drawn_.energy_bound = error * to_energy();
            const double bearable = at_rims > 0 ? settings_.energy_error * energy / at_rims : 0.0;
            const bool rims_matter = error > settings_.energy_error * energy;
            std::vector<Cell> next;
            bool is_divided = false;
            for (std::size_t i = 0; i < cells_.size(); ++i) {
                const Cell& cell = cells_[i];
                const bool divide =
                    cell.size > 2 && (doubts[i].is_bent || (rims_matter && doubts[i].rim_error > bearable));
                if (!divide || cells_.size() > kMostLeaves || division == kDivisions) {
                    next.push_back(cell);
                    continue;
                }
                is_divided = true;
                const int half = cell.size / 2;
                for (const auto& [dx, dy] : {std::array{0, 0}, {half, 0}, {0, half}, {half, half}}) {
                    next.push_back({.corner = {cell.corner.x + dx, cell.corner.y + dy}, .size = half});
                    want(next.back());
                }
            }
            if (!is_divided) {
                break;
            }
            cells_ = std::move(next);
            trace_wanted();
        }
    }

    // --- triangles

    /// The vertices on a side of a cell, from its first to before its last: those that finer neighbours have as well.
    void add_side(int x, int y, int dx, int dy, int length, std::vector<std::size_t>& around) const {
        const int half = length / 2;
        if (length > 1 && at_.contains(GhostRegion::key(x + half * dx, y + half * dy))) {
            add_side(x, y, dx, dy, half, around);
            add_side(x + half * dx, y + half * dy, dx, dy, half, around);
        } else {
            around.push_back(index(x, y));
        }
    }

    /// A fan about the cell's middle.
    const std::vector<Triangle>& triangles_of(const Cell& cell) {
        around_.clear();
        const auto [x, y] = cell.corner;
        add_side(x, y, 1, 0, cell.size, around_);
        add_side(x + cell.size, y, 0, 1, cell.size, around_);
        add_side(x + cell.size, y + cell.size, -1, 0, cell.size, around_);
        add_side(x, y + cell.size, 0, -1, cell.size, around_);
        const std::size_t middle = index(x + cell.size / 2, y + cell.size / 2);
        triangles_.clear();
        for (std::size_t i = 0; i < around_.size(); ++i) {
            triangles_.push_back({middle, around_[i], around_[(i + 1) % around_.size()]});
        }
        return triangles_;
    }

    /// Where light ceases to land between two vertices.
    struct Cut {
        Corner lit;
        Corner dark;
    };
    static std::uint64_t side_key(std::size_t lit, std::size_t dark) { return (std::uint64_t{lit} << 32U) | dark; }

    void note_cuts(const Triangle& triangle) {
        for (std::size_t i = 0; i < 3; ++i) {
            std::size_t a = triangle[i];
            std::size_t b = triangle[(i + 1) % 3];
            if (vertices_[a].lands() == vertices_[b].lands()) {
                continue;
            }
            if (!vertices_[a].lands()) {
                std::swap(a, b);
            }
            if (cut_at_.emplace(side_key(a, b), cuts_.size()).second) {
                cuts_.push_back({.lit = corner_at(a), .dark = corner_at(b)});
            }
        }
    }

    [[nodiscard]] Corner corner_at(std::size_t vertex) const {
        return {front(vertices_[vertex].place), vertices_[vertex].ray};
    }

    /// Between an end where light lands and one where it does not: by their margins where both are known, else halfway.
    static double guess(const Cut& cut) {
        const double inside = -cut.lit.ray.margin;
        const double outside = cut.dark.ray.margin;
        return cut.dark.ray.arrives && inside + outside > 0.0 ? inside / (inside + outside) : 0.5;
    }

    void cut() {
        for (int step = 0; step < kCuts; ++step) {
            offsets_.clear();
            for (const Cut& cut : cuts_) {
                // Not quite at an end, so that both close in.
                const double fraction = std::clamp(guess(cut), 0.02, 0.98);
                offsets_.push_back(offset(cut.lit.front + fraction * (cut.dark.front - cut.lit.front)));
            }
            trace(offsets_);
            for (std::size_t i = 0; i < cuts_.size(); ++i) {
                const Corner found{(1.0 / unit_) * (offsets_[i] - corner_), rays_[i]};
                (found.ray.arrives && found.ray.margin <= 0.0 ? cuts_[i].lit : cuts_[i].dark) = found;
            }
        }
    }

    [[nodiscard]] Corner rim_between(std::size_t lit, std::size_t dark) const {
        const Cut& cut = cuts_[cut_at_.at(side_key(lit, dark))];
        if (!cut.dark.ray.arrives) {
            return cut.lit;
        }
        const double fraction = guess(cut);
        Corner rim = cut.lit;
        rim.front = rim.front + fraction * (cut.dark.front - rim.front);
        rim.ray.point = rim.ray.point + fraction * (cut.dark.ray.point - rim.ray.point);
        rim.ray.transmittance += fraction * (cut.dark.ray.transmittance - rim.ray.transmittance);
        return rim;
    }

    [[nodiscard]] double to_energy() const { return unit_ * unit_ / scene_.pupil_area; }

    void draw_corners(const Corner& a, const Corner& b, const Corner& c, const DrawTriangle& draw) {
        const double area = 0.5 * std::abs(cross(b.front - a.front, c.front - a.front));
        const double mean = (a.ray.transmittance + b.ray.transmittance + c.ray.transmittance) / 3.0;
        const double energy = area * mean * to_energy();
        draw({a.ray.point, b.ray.point, c.ray.point}, energy);
        drawn_.energy += energy;
        ++drawn_.triangles;
    }

    void draw_lit(Triangle triangle, const DrawTriangle& draw) {
        const auto lands = [&](std::size_t i) { return vertices_[triangle[i]].lands(); };
        const int lit = (lands(0) ? 1 : 0) + (lands(1) ? 1 : 0) + (lands(2) ? 1 : 0);
        if (lit == 0) {
            return;
        }
        if (lit == 3) {
            draw_corners(corner_at(triangle[0]), corner_at(triangle[1]), corner_at(triangle[2]), draw);
            return;
        }
        // The corner that differs from the others comes first.
        while (lands(0) == lands(1) || lands(0) == lands(2)) {
            std::rotate(triangle.begin(), triangle.begin() + 1, triangle.end());
        }
        const auto [alone, b, c] = triangle;
        if (lit == 1) {
            draw_corners(corner_at(alone), rim_between(alone, b), rim_between(alone, c), draw);
            return;
        }
        const Corner at_b = rim_between(b, alone);
        draw_corners(corner_at(b), corner_at(c), at_b, draw);
        draw_corners(corner_at(c), at_b, rim_between(c, alone), draw);
    }

    const GhostScene& scene_;
    const optics::GhostPath& path_;
    const MeshSettings& settings_;
    Vec2d corner_;
    double unit_ = 0.0;  // mm
    std::vector<Cell> cells_;
    std::unordered_set<std::uint64_t> firsts_;
    std::vector<Vertex> vertices_;
    std::unordered_map<std::uint64_t, std::size_t> at_;
    std::size_t traced_ = 0;  // of the vertices
    std::vector<Cut> cuts_;
    std::unordered_map<std::uint64_t, std::size_t> cut_at_;
    MeshedGhost drawn_;
    std::vector<Vec2d> offsets_;  // kept for their memory
    std::vector<RimRay> rays_;
    std::vector<std::size_t> around_;
    std::vector<Triangle> triangles_;
};

}  // namespace

MeshedGhost mesh_ghost(const GhostScene& scene, const optics::GhostPath& path, const GhostRegion& region,
                       const MeshSettings& settings, const DrawTriangle& draw) {
    return Mesh(scene, path, region, settings).draw(draw);
}

}  // namespace lensproof::analysis
