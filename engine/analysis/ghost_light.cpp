#include "engine/analysis/ghost_light.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>
#include <unordered_map>

namespace lensproof::analysis {

namespace {

constexpr int kGrids = 8;

using Random = std::mt19937_64;

Vec2d draw(Random& random) {
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    const double x = unit(random);
    return {x, unit(random)};
}

/// The rays of one grid that landed, by where they stand in it.
struct GridRays {
    std::vector<LandedRay> rays;
    std::unordered_map<std::uint64_t, std::size_t> at;
    std::vector<GridCell> places;
    int traced = 0;

    [[nodiscard]] std::optional<std::size_t> find(GridCell place) const {
        const auto found = at.find(GhostRegion::key(place.x, place.y));
        return found == at.end() ? std::nullopt : std::optional(found->second);
    }

    /// What the landing moves by from the ray at a place to the next along an axis.
    [[nodiscard]] std::optional<Vec2d> step_at(GridCell place, int dx, int dy) const {
        const auto here = find(place);
        const auto next = find({place.x + dx, place.y + dy});
        const auto before = find({place.x - dx, place.y - dy});
        if (!here || (!next && !before)) {
            return std::nullopt;
        }
        return next ? rays[*next].point - rays[*here].point : rays[*here].point - rays[*before].point;
    }

    /// The same of a ray, or of one beside it where it has no neighbour on that axis; 0 of a ray by itself.
    [[nodiscard]] Vec2d step(std::size_t ray, int dx, int dy) const {
        const auto [x, y] = places[ray];
        for (const int beside : {0, 1, -1}) {
            if (const auto found = step_at({x + beside * dy, y + beside * dx}, dx, dy)) {
                return *found;
            }
        }
        return {};
    }
};

/// The rays of a square grid that stand in the region; its first node stands at `shift` spacings from the corner.
GridRays grid_rays(const GhostScene& scene, const optics::GhostPath& path, const GhostRegion& region, double spacing,
                   Vec2d shift) {
    std::vector<GridCell> places;
    std::vector<Vec2d> offsets;
    const double ray_weight = spacing * spacing / scene.pupil_area;
    const auto first_node = [&](int cell, double shifted) {
        return static_cast<int>(std::ceil(cell * region.cell / spacing - shifted));
    };
    for (const auto& [cell_x, cell_y] : region.cells) {
        for (int y = first_node(cell_y, shift.y); y < first_node(cell_y + 1, shift.y); ++y) {
            for (int x = first_node(cell_x, shift.x); x < first_node(cell_x + 1, shift.x); ++x) {
                places.push_back({x, y});
                offsets.push_back(region.corner + Vec2d{(x + shift.x) * spacing, (y + shift.y) * spacing});
            }
        }
    }
    const std::vector<std::optional<Landing>> landed = landings(scene, path, offsets);
    GridRays grid{.rays = {}, .at = {}, .places = {}, .traced = static_cast<int>(offsets.size())};
    for (std::size_t i = 0; i < landed.size(); ++i) {
        if (landed[i]) {
            grid.at.emplace(GhostRegion::key(places[i].x, places[i].y), grid.rays.size());
            grid.places.push_back(places[i]);
            grid.rays.push_back({offsets[i], landed[i]->point, ray_weight * landed[i]->transmittance});
        }
    }
    return grid;
}

/// Rays at random over what the region leaves of the front element.
std::vector<LandedRay> rays_elsewhere(const GhostScene& scene, const optics::GhostPath& path, const GhostRegion& region,
                                      int count, Random& random) {
    std::vector<Vec2d> offsets(static_cast<std::size_t>(count));
    for (Vec2d& offset : offsets) {
        do {
            offset = region.corner + scene.beam.side() * draw(random);
        } while (region.contains(offset));
    }
    const double elsewhere = scene.beam.area() - region.area();
    const std::vector<std::optional<Landing>> found = landings(scene, path, offsets);
    std::vector<LandedRay> landed;
    for (std::size_t i = 0; i < found.size(); ++i) {
        if (found[i]) {
            landed.push_back(
                {offsets[i], found[i]->point, elsewhere / count * found[i]->transmittance / scene.pupil_area});
        }
    }
    return landed;
}

}  // namespace

Footprint::Footprint(double radius)
    : radius_(radius), pixel_(2.0 * radius / kPixels), pixels_(static_cast<std::size_t>(kPixels) * kPixels) {}

void Footprint::clear() {
    std::ranges::fill(pixels_, 0.0);
}

void Footprint::add_point(Vec2d at, double energy) {
    const double x = (at.x + radius_) / pixel_ - 0.5;
    const double y = (at.y + radius_) / pixel_ - 0.5;
    if (!(x > 0.0 && y > 0.0 && x < kPixels - 1 && y < kPixels - 1)) {
        return;  // outside the circle, but for points that it touches the square at
    }
    const auto left = static_cast<std::size_t>(x);
    const auto low = static_cast<std::size_t>(y);
    const double right_weight = x - static_cast<double>(left);
    const double high_weight = y - static_cast<double>(low);
    double* pixel = &pixels_[low * kPixels + left];
    pixel[0] += energy * (1.0 - right_weight) * (1.0 - high_weight);
    pixel[1] += energy * right_weight * (1.0 - high_weight);
    pixel[kPixels] += energy * (1.0 - right_weight) * high_weight;
    pixel[kPixels + 1] += energy * right_weight * high_weight;
}

void Footprint::add(Vec2d centre, Vec2d u, Vec2d v, double energy) {
    const auto pieces = [&](const Vec2d& side) {
        return static_cast<int>(std::clamp(std::ceil(2.0 * length(side) / pixel_), 1.0, 2.0 * kPixels));
    };
    const int along_u = pieces(u);
    const int along_v = pieces(v);
    for (int i = 0; i < along_u; ++i) {
        for (int j = 0; j < along_v; ++j) {
            const Vec2d at = centre + ((i + 0.5) / along_u - 0.5) * u + ((j + 0.5) / along_v - 0.5) * v;
            add_point(at, energy / (along_u * along_v));
        }
    }
}

double Footprint::peak() const {
    double largest = 0.0;
    for (int y = 1; y + 1 < kPixels; ++y) {
        for (int x = 1; x + 1 < kPixels; ++x) {
            double sum = 0.0;
            for (int row = y - 1; row <= y + 1; ++row) {
                const double* first =
                    &pixels_[static_cast<std::size_t>(row) * kPixels + static_cast<std::size_t>(x) - 1];
                sum += first[0] + first[1] + first[2];
            }
            largest = std::max(largest, sum);
        }
    }
    return largest / (patch() * patch());
}

GhostLight measure_ghost(const GhostScene& scene, const optics::GhostPath& path, const GhostRegion& region,
                         const GhostSampling& sampling, Footprint* footprint) {
    std::vector<std::uint32_t> seeds{static_cast<std::uint32_t>(sampling.seed),
                                     static_cast<std::uint32_t>(sampling.seed >> 32U)};
    seeds.insert(seeds.end(), path.begin(), path.end());
    std::seed_seq seed(seeds.begin(), seeds.end());
    Random random(seed);
    GhostLight light;
    const double a_grid = static_cast<double>(sampling.rays) / kGrids;
    const double spacing = std::sqrt(region.area() / a_grid);
    constexpr double kElsewhere = 1.0 / 30.0;
    const int elsewhere = region.cells.empty() ? 64 : 1 + static_cast<int>(kElsewhere * a_grid);
    std::vector<double> energies;
    Vec2d moment{};
    double second_moment = 0.0;
    const auto count = [&](const LandedRay& ray) {
        moment = moment + ray.energy * ray.point;
        second_moment += ray.energy * dot(ray.point, ray.point);
        energies.back() += ray.energy;
        ++light.landed;
    };
    for (int i = 0; i < kGrids; ++i) {
        energies.push_back(0.0);
        GridRays grid = grid_rays(scene, path, region, spacing, draw(random));
        const std::vector<LandedRay> others = rays_elsewhere(scene, path, region, elsewhere, random);
        std::ranges::for_each(grid.rays, count);
        std::ranges::for_each(others, count);
        light.rays += grid.traced + elsewhere;
        if (i > 0) {
            continue;
        }
        if (footprint != nullptr) {
            footprint->clear();
            for (std::size_t ray = 0; ray < grid.rays.size(); ++ray) {
                footprint->add(grid.rays[ray].point, grid.step(ray, 1, 0), grid.step(ray, 0, 1), grid.rays[ray].energy);
            }
            light.peak = footprint->peak();
        }
        light.first_grid = std::move(grid.rays);
    }
    double sum = 0.0;
    for (const double energy : energies) {
        sum += energy;
    }
    light.energy = sum / kGrids;
    double squares = 0.0;
    for (const double energy : energies) {
        squares += (energy - light.energy) * (energy - light.energy);
    }
    light.standard_error = std::sqrt(squares / (kGrids * (kGrids - 1)));
    if (sum > 0.0) {
        light.centroid = (1.0 / sum) * moment;
        light.rms_radius = std::sqrt(std::max(0.0, second_moment / sum - dot(light.centroid, light.centroid)));
    }
    return light;
}

}  // namespace lensproof::analysis
