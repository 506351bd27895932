// How far polynomials are from their lens.
#include <algorithm>
#include <array>
#include <cmath>

#include "engine/base/order_statistics.h"
#include "engine/polynomial/polynomial_fit.h"
#include "engine/polynomial/ray_samples.h"

namespace lensproof::polynomial {

PolynomialError measured_error(const PolynomialLens& polynomial, const std::vector<optics::TraceLens<double>>& lenses,
                               const pupil::PupilMap& pupil, std::uint64_t first, int count) {
    constexpr std::size_t kRings = 8;
    constexpr double kSpare = 1.25;  // of the bound, for other rays
    const PolynomialFrame& frame = polynomial.frame();
    const RaySampler sampler(lenses, pupil, frame.film_radius_mm, frame.front_curvature);
    std::vector<double> misses;
    double squares = 0.0;
    double beside = 0.0;
    std::array<double, kRings> exact{};
    std::array<double, kRings> found{};
    for (const RaySample& ray : sampler.samples(first, count)) {
        const PolynomialExit out = polynomial.exit(ray.film, ray.pupil, ray.wavelength);
        const double fraction = dot(ray.film, ray.film) / (frame.film_radius_mm * frame.film_radius_mm);
        const std::size_t ring = std::min(kRings - 1, static_cast<std::size_t>(kRings * fraction));
        found[ring] += ray.etendue * out.transmittance;
        if (!ray.passes) {
            continue;
        }
        exact[ring] += ray.etendue * ray.transmittance;
        const ExitPoint<double> exit = exit_point(out.ray, frame.front_curvature);
        const std::optional<Vec2d> landing = sampler.landing(exit, ray.wavelength);
        const double miss = landing ? length(*landing - ray.film) : frame.film_radius_mm;
        const Vec2d aside = exit.u - ray.exit.u;
        misses.push_back(1e3 * miss);
        squares += 1e6 * miss * miss;
        beside += 4e6 * dot(aside, aside);  // u is half a length
    }
    PolynomialError error;
    if (misses.empty()) {
        return error;
    }
    const auto rays = static_cast<double>(misses.size());
    error = {.rms_um = std::sqrt(squares / rays),
             .bound_um = kSpare * quantile(misses, 0.999),
             .entry_rms_um = std::sqrt(beside / rays)};
    double sum_exact = 0.0;
    double sum_found = 0.0;
    for (std::size_t i = 0; i < kRings; ++i) {
        sum_exact += exact[i];
        sum_found += found[i];
        const double off = exact[i] > 0.0 ? found[i] / exact[i] - 1.0 : 0.0;
        error.worst_irradiance = std::abs(off) > std::abs(error.worst_irradiance) ? off : error.worst_irradiance;
    }
    error.irradiance = sum_found / sum_exact - 1.0;
    return error;
}

}  // namespace lensproof::polynomial
