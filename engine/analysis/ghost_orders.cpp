#include "engine/analysis/ghost_orders.h"

#include <algorithm>
#include <cmath>

#include "engine/base/parallel.h"

namespace lensproof::analysis {

namespace {

using TravellingRay = optics::TravellingRay<double>;
using Bundle = std::vector<TravellingRay>;

/// One branch's search.
class Branches {
  public:
    Branches(const GhostScene& scene, double tolerance, double ray_weight)
        : scene_(scene),
          tolerance_(tolerance),
          ray_weight_(ray_weight),
          sensor_(static_cast<int>(scene.lens.surfaces.size())) {
        for (const int index : reflectors(scene)) {
            reflects_.resize(static_cast<std::size_t>(index) + 1);
            reflects_.back() = true;
        }
        reflects_.resize(static_cast<std::size_t>(sensor_) + 1);
    }

    /// The light that comes as far as `to`, going in steps of `step`.
    [[nodiscard]] Bundle passed(Bundle bundle, int index, optics::AtSurface what, int step) const {
        Bundle next;
        for (TravellingRay& ray : bundle) {
            const bool goes_on = index == sensor_ ? optics::reflect_at_sensor(scene_.lens, scene_.mirrors, ray)
                                                  : optics::run_to_surface<optics::Rims::clip>(
                                                        scene_.lens, index, step > 0, what, scene_.mirrors, ray)
                                                        .second;
            if (goes_on && ray.transmittance(scene_.lens) > 0.0) {
                next.push_back(ray);
            }
        }
        return next;
    }

    /// Follows what stands behind the last reflection of `path`, and reflects it wherever light meets a surface.
    void grow(const optics::GhostPath& path, Bundle bundle, int step, RankedGhosts& found, int only = -1) const {
        for (int index = path.empty() ? 0 : path.back() + step; index >= 0 && index <= sensor_ && !bundle.empty();
             index += step) {
            if (reflects_[static_cast<std::size_t>(index)] && (only < 0 || only == index)) {
                optics::GhostPath longer = path;
                longer.push_back(index);
                branch(longer, passed(bundle, index, optics::AtSurface::reflect, step), -step, found);
            }
            if (index == sensor_ || index == only) {
                return;
            }
            bundle = passed(std::move(bundle), index, optics::AtSurface::pass, step);
        }
    }

  private:
    void branch(const optics::GhostPath& path, const Bundle& bundle, int step, RankedGhosts& found) const {
        constexpr std::size_t kMostReflections = 4;
        const bool is_end = path.size() == kMostReflections;
        const double bound = is_end ? end_bound(path, bundle) : energy(bundle);
        if (bound < tolerance_) {
            found.skipped_energy_bound += bound;
        } else if (is_end) {
            found.paths.push_back(path);
        } else {
            grow(path, bundle, step, found);
        }
    }

    [[nodiscard]] double energy(const Bundle& bundle) const {
        double sum = 0.0;
        for (const TravellingRay& ray : bundle) {
            sum += ray_weight_ * ray.transmittance(scene_.lens);
        }
        return sum;
    }

    [[nodiscard]] double end_bound(const optics::GhostPath& path, const Bundle& bundle) const {
        double largest = 0.0;
        for (const TravellingRay& ray : bundle) {
            largest = std::max(largest, ray_weight_ * ray.transmittance(scene_.lens));
        }
        Bundle out = bundle;
        for (int index = path.back() + 1; index < sensor_; ++index) {
            out = passed(std::move(out), index, optics::AtSurface::pass, 1);
        }
        std::erase_if(out, [&](const TravellingRay& ray) {
            if (!(ray.direction.z > 0.0)) {
                return true;
            }
            const Vec3d point = optics::meet_plane(ray.global(), scene_.lens.image_z).point;
            return std::hypot(point.x, point.y) > scene_.image_radius;
        });
        const double allowance = 3.0 * std::sqrt(static_cast<double>(out.size())) + 3.0;
        return std::min(energy(bundle), energy(out) + allowance * largest);
    }

    const GhostScene& scene_;
    double tolerance_;
    double ray_weight_;
    int sensor_;
    std::vector<bool> reflects_;
};

}  // namespace

std::vector<int> reflectors(const GhostScene& scene) {
    std::vector<int> found;
    const int sensor = static_cast<int>(scene.lens.surfaces.size());
    for (int i = 0; i < sensor; ++i) {
        const optics::TraceSurface<double>& surface = scene.lens.surfaces[static_cast<std::size_t>(i)];
        const optics::TraceCoating<double>* coating =
            surface.special >= 0 ? &scene.lens.specials[static_cast<std::size_t>(surface.special)].coating : nullptr;
        const bool is_mirror = coating != nullptr && coating->is_mirror;  // sends all on, nothing back
        const bool is_glass =
            surface.index_before != surface.index_after || (coating != nullptr && !coating->is_bare());
        if (!is_mirror && (optics::reflects_by_blades(surface) ? scene.mirrors.blades > 0.0 : is_glass)) {
            found.push_back(i);
        }
    }
    if (scene.mirrors.sensor > 0.0) {
        found.push_back(sensor);
    }
    return found;
}

std::vector<optics::GhostPath> ghosts_of_two(const GhostScene& scene) {
    std::vector<optics::GhostPath> paths;
    const std::vector<int> found = reflectors(scene);
    for (std::size_t a = 1; a < found.size(); ++a) {
        for (std::size_t b = 0; b < a; ++b) {
            paths.push_back({found[a], found[b]});
        }
    }
    return paths;
}

RankedGhosts ghosts_of_four(const GhostScene& scene, double tolerance, int threads) {
    constexpr int kAcross = 40;
    const double spacing = scene.beam.side() / kAcross;
    Bundle front;
    for (int row = 0; row < kAcross; ++row) {
        for (int column = 0; column < kAcross; ++column) {
            const Ray<double> ray = scene.beam.ray(scene.beam.corner() + spacing * Vec2d{column + 0.5, row + 0.5});
            front.push_back({.origin = ray.origin, .direction = ray.direction});
        }
    }
    const Branches branches(scene, tolerance, spacing * spacing / scene.pupil_area);
    const std::vector<int> first = reflectors(scene);
    std::vector<RankedGhosts> parts(first.size());
    parallel_for(static_cast<int>(first.size()), threads, [&](int i) {
        branches.grow({}, front, 1, parts[static_cast<std::size_t>(i)], first[static_cast<std::size_t>(i)]);
    });
    RankedGhosts all;
    for (const RankedGhosts& part : parts) {
        all.paths.insert(all.paths.end(), part.paths.begin(), part.paths.end());
        all.skipped_energy_bound += part.skipped_energy_bound;
    }
    return all;
}

}  // namespace lensproof::analysis
