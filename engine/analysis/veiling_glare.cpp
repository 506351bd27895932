#include "engine/analysis/veiling_glare.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <optional>
#include <random>
#include <vector>

#include "engine/analysis/ghosts.h"
#include "engine/base/input_error.h"
#include "engine/base/parallel.h"
#include "engine/optics/paraxial.h"
#include "engine/optics/stray_walk.h"
#include "engine/pupil/rear_disc.h"

namespace lensproof::analysis {

namespace {

constexpr int kBatches = 64;  // each with numbers of its own, on any thread

/// What one batch saw: of each class what came from beside the spot, and of all paths what came from anywhere.
using Sums = std::array<double, 4>;
enum Class { ghosts, barrel, blur, all };

class BatchNumbers {
  public:
    BatchNumbers(std::uint64_t seed, int batch) {
        std::seed_seq words{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32U),
                            static_cast<std::uint32_t>(batch)};
        random_.seed(words);
    }
    double operator()() { return uniform_(random_); }

  private:
    std::mt19937_64 random_;
    std::uniform_real_distribution<double> uniform_{0.0, 1.0};
};

/// Whether a ray out of the lens ends on the spot.
bool sees_spot(const Ray<double>& out, const VeilingGlareSettings& settings) {
    if (!(out.direction.z < 0.0)) {
        return false;
    }
    if (std::isinf(settings.object_distance)) {
        return std::hypot(out.direction.x, out.direction.y) <= std::sin(settings.spot_angle);
    }
    const Vec3d at = optics::meet_plane(out, -settings.object_distance).point;
    return std::hypot(at.x, at.y) <= settings.object_distance * std::tan(settings.spot_angle);
}

/// The share of the mean, and the standard error of such a ratio, to first order, from how batches differ.
GlareShare share_of(const std::vector<Sums>& batches, const Sums& total, std::initializer_list<Class> classes) {
    const auto sum = [&](const Sums& sums) {
        double found = 0.0;
        for (const Class one : classes) {
            found += sums[one];
        }
        return found;
    };
    const double share = sum(total) / total[all];
    double squares = 0.0;
    for (const Sums& batch : batches) {
        const double residual = sum(batch) - share * batch[all];
        squares += residual * residual;
    }
    const double n = kBatches;
    return {share, std::sqrt(squares * n / (n - 1.0)) / total[all]};
}

}  // namespace

double tenth_of_field(const optics::Lens& lens, double wavelength_nm) {
    const double efl = optics::paraxial_data(optics::at_wavelength<double>(lens, wavelength_nm)).efl;
    const std::optional<double> radius = image_radius(lens, wavelength_nm);
    if (!std::isfinite(efl) || efl == 0.0 || !radius) {
        throw InputError(
            fmt::format("{}: its veiling glare has no black spot: expected a lens with a focal length and "
                        "an image circle (stated.image_circle_mm)",
                        lens.name));
    }
    return std::atan(0.1 * *radius / std::abs(efl));
}

VeilingGlare veiling_glare(const optics::Lens& lens, const VeilingGlareSettings& settings) {
    const optics::TraceLens<double> at = optics::at_wavelength<double>(lens, settings.wavelength_nm);
    const optics::Barrel walls(lens);
    const pupil::RearDisc disc = pupil::rear_disc(at, 0.0);
    const double to_disc = at.image_z - disc.plane_z;
    std::vector<Sums> batches(kBatches, Sums{});
    const auto run = [&](int batch) {
        BatchNumbers numbers(settings.seed, batch);
        Sums& sums = batches[static_cast<std::size_t>(batch)];
        for (std::int64_t i = batch; i < settings.paths; i += kBatches) {
            const double u = numbers();
            const Vec2d place = disc.warped(u, numbers());
            const Vec3d direction = normalized(Vec3d{place.x, place.y, -to_disc});
            const double projected = std::pow(direction.z, 4) / (to_disc * to_disc);  // solid angle a mm² of the disc
            optics::StrayLight light{.ray = {{0.0, 0.0, at.image_z}, direction}};
            optics::StrayWalk walk(at, walls, settings.mirrors, numbers);
            if (walk.follow(light, false, [](const optics::StrayLight&) {}) != optics::StrayEnd::front) {
                continue;
            }
            const double seen = projected * light.weight;
            sums[all] += seen;
            if (!sees_spot(light.ray, settings)) {
                sums[light.walls > 0 ? barrel : light.reflections > 0 ? ghosts : blur] += seen;
            }
        }
    };
    parallel_for(kBatches, settings.threads, run);
    Sums total{};
    for (const Sums& batch : batches) {
        for (std::size_t i = 0; i < total.size(); ++i) {
            total[i] += batch[i];
        }
    }
    if (!(total[all] > 0.0)) {
        return {.spot_angle = settings.spot_angle};
    }
    return {.index = share_of(batches, total, {ghosts, barrel, blur}),
            .ghosts = share_of(batches, total, {ghosts}),
            .barrel = share_of(batches, total, {barrel}),
            .blur = share_of(batches, total, {blur}),
            .spot_angle = settings.spot_angle,
            .irradiance = disc.area() * total[all] / static_cast<double>(settings.paths)};
}

}  // namespace lensproof::analysis
