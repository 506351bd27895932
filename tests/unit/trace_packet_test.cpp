// Packets of rays against the same rays one by one: the same fate, and the same bits.
#include "engine/optics/trace_packet.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "engine/optics/convert_lens.h"
#include "engine/optics/lens.h"

namespace lensproof {
namespace {

/// Rays towards the front of `lens` from all sides, so that some pass, some are clipped, miss or are reflected.
std::vector<Ray<double>> rays_at(const Lens& lens, int count, double steepest) {
    std::mt19937_64 random(11);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    std::vector<Ray<double>> rays;
    const double reach = 1.2 * lens.surfaces.front().semi_diameter;
    for (int i = 0; i < count; ++i) {
        const double angle = steepest * unit(random);
        const Vec3d direction = normalized(Vec3d{0.2 * unit(random), std::sin(angle), std::cos(angle)});
        const Vec3d at{reach * unit(random), reach * unit(random), 0.0};
        rays.push_back({at - 40.0 * direction, direction});
    }
    return rays;
}

template <class Scalar>
void expect_same(const TracedRay<Scalar>& lane, const TracedRay<Scalar>& alone) {
    EXPECT_EQ(lane.status, alone.status);
    EXPECT_EQ(lane.surface, alone.surface);
    EXPECT_EQ(lane.ray.origin, alone.ray.origin);
    EXPECT_EQ(lane.ray.direction, alone.ray.direction);
    EXPECT_EQ(lane.optical_path, alone.optical_path);
    EXPECT_EQ(lane.transmittance, alone.transmittance);
}

/// Which fates the rays had, so that a test can say that it saw them all.
using Fates = std::array<int, 5>;

template <Direction direction, Rims rims, class Scalar, int N>
Fates compare_lanes(const TraceLens<double>& lens, const std::vector<Ray<double>>& rays) {
    const TraceLens<Scalar> own = convert_lens<Scalar>(lens);
    Fates fates{};
    for (std::size_t first = 0; first + N <= rays.size(); first += N) {
        Ray<Pack<Scalar, N>> packet;
        std::array<Ray<Scalar>, N> single;
        for (int lane = 0; lane < N; ++lane) {
            single[lane] = convert_ray<Scalar>(rays[first + lane]);
            set_lane(packet, lane, single[lane]);
        }
        const TracedPacket<Scalar, N> together = trace_packet<direction, rims>(own, packet);
        for (int lane = 0; lane < N; ++lane) {
            const TracedRay<Scalar> alone = trace<direction, rims>(own, single[lane]);
            expect_same(together.lane(lane), alone);
            ++fates[static_cast<std::size_t>(alone.status)];
        }
    }
    return fates;
}

TEST(TracePacket, EveryLaneHasTheBitsOfTheScalar) {
    Fates seen{};
    for (const char* name : {"tessar", "petzval", "muller-fisheye"}) {
        const Lens lens = load_lens(name);
        const TraceLens<double> at = at_wavelength<double>(lens, 550.0);
        const std::vector<Ray<double>> rays = rays_at(lens, 800, name[0] == 'm' ? 1.8 : 0.6);
        for (const Fates& fates : {compare_lanes<Direction::forward, Rims::clip, float, 8>(at, rays),
                                   compare_lanes<Direction::forward, Rims::follow, float, 8>(at, rays),
                                   compare_lanes<Direction::forward, Rims::clip, double, 4>(at, rays),
                                   compare_lanes<Direction::forward, Rims::follow, double, 4>(at, rays)}) {
            for (std::size_t i = 0; i < seen.size(); ++i) {
                seen[i] += fates[i];
            }
        }
    }
    for (const RayStatus status : {RayStatus::ok, RayStatus::missed, RayStatus::clipped,
                                   RayStatus::total_internal_reflection, RayStatus::stopped}) {
        EXPECT_GT(seen[static_cast<std::size_t>(status)], 20) << status_name(status);
    }
}

TEST(TracePacket, GoesBackwardsToo) {
    const Lens lens = load_lens("tessar");
    std::vector<Ray<double>> rays = rays_at(lens, 400, 0.6);
    for (Ray<double>& ray : rays) {
        ray = {{ray.origin.x, ray.origin.y, lens.image_z}, -1.0 * ray.direction};
    }
    compare_lanes<Direction::reverse, Rims::clip, float, 8>(at_wavelength<double>(lens, 550.0), rays);
    compare_lanes<Direction::reverse, Rims::follow, double, 2>(at_wavelength<double>(lens, 550.0), rays);
}

// A closed stop stops every lane, the one on the axis too.
TEST(TracePacket, AClosedStopStopsEveryLane) {
    const Lens lens = load_lens("tessar");
    TraceLens<double> at = at_wavelength<double>(lens, 550.0);
    at.surfaces[static_cast<std::size_t>(lens.stop_index())].semi_diameter_squared = 0.0;
    std::vector<Ray<double>> rays = rays_at(lens, 7, 0.1);
    rays.push_back({{0.0, 0.0, -10.0}, {0.0, 0.0, 1.0}});
    const Fates fates = compare_lanes<Direction::forward, Rims::clip, float, 8>(at, rays);
    EXPECT_EQ(fates[static_cast<std::size_t>(RayStatus::ok)], 0);
    EXPECT_GT(fates[static_cast<std::size_t>(RayStatus::stopped)], 0);
}

// A lens with a shaped, tilted surface goes lane by lane.
TEST(TracePacket, TracesWhatIsNoSphere) {
    const Lens lens = load_lens("tessar");
    TraceLens<double> at = at_wavelength<double>(lens, 550.0);
    SpecialSurface<double> special;
    special.has_shape = true;
    special.shape = {.curvature = at.surfaces[2].curvature, .conic = -0.5, .asphere = {0.0, 1e-6}, .terms = 2};
    special.vertex = {0.0, 0.3};
    at.specials.push_back(special);
    at.surfaces[2].special = 0;
    const Fates fates = compare_lanes<Direction::forward, Rims::clip, float, 4>(at, rays_at(lens, 400, 0.6));
    EXPECT_GT(fates[static_cast<std::size_t>(RayStatus::ok)], 20);
}

}  // namespace
}  // namespace lensproof
