#include "experiments/studies/tradeoff/chief_images.h"

#include <algorithm>
#include <cmath>

#include "engine/base/parallel.h"
#include "engine/optics/chief_ray.h"
#include "engine/render/camera/gaussian_optics.h"
#include "experiments/studies/tradeoff/point_sums.h"

namespace lensproof::studies {

namespace {

/// On the sensor's plane, lens space, mm. `from`: of the lens's rotation, so that its azimuth does not matter to rays.
std::optional<Vec2d> image_of(const optics::ChiefRays& rays, const render::LightOrigin& from) {
    const double across = std::hypot(from.at.x, from.at.y);
    const Vec2d outwards = across > 0.0 ? (1.0 / across) * Vec2d{from.at.x, from.at.y} : Vec2d{0.0, 1.0};
    const auto chief = from.is_far ? rays.at_field(std::atan2(across, from.at.z)) : rays.from_point(across, from.at.z);
    return chief ? std::optional(chief->image_height * outwards) : std::nullopt;
}

}  // namespace

std::vector<std::optional<ChiefImage>> chief_images(const render::Camera& exact, const std::vector<ProbePoint>& points,
                                                    int threads) {
    std::vector<std::optional<ChiefImage>> images(points.size());
    const optics::Lens& lens = exact.lens().value();
    if (!lens.is_rotationally_symmetric) {
        return images;
    }
    const spectral::WavelengthStrata& strata = exact.grid().strata;
    std::vector<optics::ChiefRays> rays;
    std::vector<std::array<double, 3>> weights;
    for (int i = 0; i < strata.count; ++i) {
        rays.emplace_back(lens, strata.midpoint(i), optics::Rims::follow);
        const double transmittance = render::axial_transmittance(lens, strata.midpoint(i));
        const Vec3d& rgb = exact.film().rgb_weights[static_cast<std::size_t>(i)];
        const auto of = [&](double weight) { return transmittance * std::max(0.0, weight); };
        weights.push_back({of(rgb.x), of(rgb.y), of(rgb.z)});
    }
    parallel_for(static_cast<int>(points.size()), threads, [&](int at) {
        const auto p = static_cast<std::size_t>(at);
        const render::LightOrigin from = exact.in_lens_space(points[p].origin);
        Landings landings;
        for (std::size_t i = 0; i < rays.size(); ++i) {
            const std::optional<Vec2d> image = image_of(rays[i], from);
            if (!image) {
                return;
            }
            for (std::size_t c = 0; c < landings.size(); ++c) {
                landings[c].add(weights[i][c], exact.sensor().pixel(*image) - points[p].at_px);
            }
        }
        ChiefImage& found = images[p].emplace();
        for (std::size_t c = 0; c < landings.size(); ++c) {
            if (landings[c].light > 0.0) {
                found.at[c] = landings[c].centroid();
                found.squared_spread[c] = std::pow(landings[c].spread(), 2);
            }
        }
    });
    return images;
}

}  // namespace lensproof::studies
