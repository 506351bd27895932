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
#include "engine/optics/polarised_ray.h"
#include "engine/optics/stray_walk.h"
#include "engine/pupil/rear_disc.h"

namespace lensproof::analysis {

namespace {

constexpr int kBatches = 64;  // each with numbers of its own, on any thread

/// What one batch saw: of each class what came from beside the spot, and of all paths what came from anywhere.
using Sums = std::array<double, 4>;
enum Class { ghosts, barrel, blur, all };

/// By averages at each surface, and with polarisation carried.
struct Seen {
    Sums averaged{};
    Sums carried{};
};

/// Carries a walk's polarisation.
struct PolarisationWitness {
    optics::PolarisedRay<double>* light;

    void at_surface(optics::AtSurface what, int index, bool forward, const Ray<double>& on) const {
        light->meet(what, index, forward, on.origin, on.direction);
    }
    void at_mirror() const { light->meet_mirror({0.0, 0.0, 1.0}); }
    void at_wall(const Vec3d& scattered_along) const { light->depolarise(scattered_along); }
};

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

double sum_of(const Sums& sums, std::initializer_list<Class> classes) {
    double found = 0.0;
    for (const Class one : classes) {
        found += sums[one];
    }
    return found;
}

/// The standard error of what batches add up to, from how they differ.
template <class Residual>
double error_of_sum(const std::vector<Seen>& batches, const Residual& residual) {
    double squares = 0.0;
    for (const Seen& batch : batches) {
        squares += residual(batch) * residual(batch);
    }
    const double n = kBatches;
    return std::sqrt(squares * n / (n - 1.0));
}

/// The fraction of the mean, and the standard error of such a ratio, to first order.
GlareFraction fraction_of(const std::vector<Seen>& batches, const Seen& total, Sums Seen::*which,
                          std::initializer_list<Class> classes) {
    const double whole = (total.*which)[all];
    const double fraction = sum_of(total.*which, classes) / whole;
    const auto residual = [&](const Seen& batch) {
        return sum_of(batch.*which, classes) - fraction * (batch.*which)[all];
    };
    return {fraction, error_of_sum(batches, residual) / whole};
}

PolarisedGlare polarised_glare(const std::vector<Seen>& batches, const Seen& total) {
    const auto fraction = [&](std::initializer_list<Class> classes) {
        return fraction_of(batches, total, &Seen::carried, classes);
    };
    PolarisedGlare glare{.index = fraction({ghosts, barrel, blur}),
                         .ghosts = fraction({ghosts}),
                         .barrel = fraction({barrel}),
                         .blur = fraction({blur}),
                         .difference = {}};
    const double averaged = fraction_of(batches, total, &Seen::averaged, {ghosts, barrel, blur}).fraction;
    const auto residual = [&](const Seen& batch) {
        const auto of = [&](const Sums& sums, double index, double whole) {
            return (sum_of(sums, {ghosts, barrel, blur}) - index * sums[all]) / whole;
        };
        return of(batch.carried, glare.index.fraction, total.carried[all]) -
               of(batch.averaged, averaged, total.averaged[all]);
    };
    glare.difference = {glare.index.fraction - averaged, error_of_sum(batches, residual)};
    return glare;
}

/// Adds the paths of one batch up. The random decisions are those of unpolarised light, whether or not polarisation is
/// carried, which weighs the path at its end.
class GlarePaths {
  public:
    GlarePaths(const optics::Lens& lens, const VeilingGlareSettings& settings)
        : settings_(settings),
          at_(optics::at_wavelength<double>(lens, settings.wavelength_nm)),
          walls_(lens),
          disc_(pupil::rear_disc(at_, 0.0)) {}

    [[nodiscard]] double disc_area() const { return disc_.area(); }

    [[nodiscard]] Seen of_batch(int batch) const {
        BatchNumbers numbers(settings_.seed, batch);
        Seen seen;
        for (std::int64_t i = batch; i < settings_.paths; i += kBatches) {
            add_path(numbers, seen);
        }
        return seen;
    }

  private:
    void add_path(BatchNumbers& numbers, Seen& seen) const {
        const double to_disc = at_.image_z - disc_.plane_z;
        const double u = numbers();
        const Vec2d place = disc_.warped(u, numbers());
        const Vec3d direction = normalized(Vec3d{place.x, place.y, -to_disc});
        const double projected = std::pow(direction.z, 4) / (to_disc * to_disc);  // solid angle a mm² of the disc
        optics::StrayLight light{.ray = {{0.0, 0.0, at_.image_z}, direction}};
        optics::PolarisedRay<double> polarised(at_, direction);
        const auto leaves_at_front = [&](auto witness) {
            optics::StrayWalk walk(at_, walls_, settings_.mirrors, numbers, witness);
            return walk.follow(light, false, [](const optics::StrayLight&) {}) == optics::StrayEnd::front;
        };
        if (!(settings_.polarised ? leaves_at_front(PolarisationWitness{&polarised})
                                  : leaves_at_front(optics::NoWitness{}))) {
            return;
        }
        const Class found = light.walls > 0 ? barrel : light.reflections > 0 ? ghosts : blur;
        const auto add = [&](Sums& sums, double weight) {
            sums[all] += weight;
            if (!sees_spot(light.ray, settings_)) {
                sums[found] += weight;
            }
        };
        add(seen.averaged, projected * light.weight);
        if (settings_.polarised) {
            add(seen.carried, projected * light.weight * polarised.factor());
        }
    }

    const VeilingGlareSettings& settings_;
    optics::TraceLens<double> at_;
    optics::Barrel walls_;
    pupil::RearDisc disc_;
};

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
    optics::require_refraction_alone(lens, "veiling glare");
    const GlarePaths paths(lens, settings);
    std::vector<Seen> batches(kBatches);
    parallel_for(kBatches, settings.threads,
                 [&](int batch) { batches[static_cast<std::size_t>(batch)] = paths.of_batch(batch); });
    Seen total;
    for (const Seen& batch : batches) {
        for (std::size_t i = 0; i < total.averaged.size(); ++i) {
            total.averaged[i] += batch.averaged[i];
            total.carried[i] += batch.carried[i];
        }
    }
    if (!(total.averaged[all] > 0.0)) {
        return {.spot_angle = settings.spot_angle};
    }
    const auto fraction = [&](std::initializer_list<Class> classes) {
        return fraction_of(batches, total, &Seen::averaged, classes);
    };
    VeilingGlare glare{.index = fraction({ghosts, barrel, blur}),
                       .ghosts = fraction({ghosts}),
                       .barrel = fraction({barrel}),
                       .blur = fraction({blur}),
                       .spot_angle = settings.spot_angle,
                       .irradiance = paths.disc_area() * total.averaged[all] / static_cast<double>(settings.paths)};
    if (settings.polarised) {
        glare.polarised = polarised_glare(batches, total);
    }
    return glare;
}

}  // namespace lensproof::analysis
