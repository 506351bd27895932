// The wavelengths of a ray along a ghost, side by side, against each by itself: the same fate, and the same bits.
#include "engine/optics/packet/ghost_lanes.h"

#include <gtest/gtest.h>

#include <random>

#include "engine/formats/prescription/load_lens.h"
#include "tests/engine/optics/packet/varied_tessars.h"
#include "tests/engine/optics/some_ghosts.h"

namespace lensproof::optics::ghost_lanes_test {

/// And some that the sensor takes part in.
std::vector<GhostPath> some_paths(int surfaces) {
    std::vector<GhostPath> paths = some_ghosts(surfaces);
    for (int last = 1; last < surfaces; ++last) {
        paths.push_back({surfaces, last});
    }
    return paths;
}

struct Fates {
    int arrived = 0;
    int ended = 0;
    int parted = 0;  // some of the wavelengths alone arrive
};

/// Rays towards the front from all sides along every ghost, at wavelengths far apart.
Fates compare(const Lens& lens, const SpectralLens<double>& at, double steepest) {
    std::mt19937_64 random(5);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    const StrayMirrors<double> mirrors{.sensor = 0.3, .blades = 0.1};
    Fates fates;
    for (const GhostPath& path : some_paths(static_cast<int>(lens.surfaces.size()))) {
        for (int i = 0; i < 40; ++i) {
            const double angle = steepest * unit(random);
            const Vec3d direction = normalized(Vec3d{0.1 * unit(random), std::sin(angle), std::cos(angle)});
            const double reach = 0.8 * lens.surfaces.front().semi_diameter;
            const Ray<double> ray{Vec3d{reach * unit(random), reach * unit(random), 0.0} - 40.0 * direction, direction};
            const std::array<std::uint16_t, 4> wavelengths{0, 1, 2, static_cast<std::uint16_t>(i % 3)};
            for (const SimdLevel level : available_simd_levels()) {
                const GhostLanes together = trace_ghost_lanes(at, wavelengths, path, ray, mirrors, level);
                int arrived = 0;
                for (std::size_t lane = 0; lane < kGhostLanes; ++lane) {
                    const TracedRay<double> alone = trace_ghost(at.at(wavelengths[lane]), path, ray, mirrors);
                    EXPECT_EQ(together.arrives[lane], alone.status == RayStatus::ok) << simd_name(level);
                    if (together.arrives[lane] && alone.status == RayStatus::ok) {
                        EXPECT_EQ(together.ray[lane].origin, alone.ray.origin) << simd_name(level);
                        EXPECT_EQ(together.ray[lane].direction, alone.ray.direction) << simd_name(level);
                        EXPECT_EQ(together.transmittance[lane], alone.transmittance) << simd_name(level);
                        ++arrived;
                    }
                }
                if (level == SimdLevel::scalar) {  // once, however many levels there are
                    fates.arrived += arrived;
                    fates.ended += 4 - arrived;
                    fates.parted += arrived % 4 != 0 ? 1 : 0;
                }
            }
        }
    }
    return fates;
}

/// Rays as those of `compare`, past rims: what becomes of eight together is what becomes of each.
Fates compare_followed(const Lens& lens, const SpectralLens<double>& at, double steepest) {
    std::mt19937_64 random(6);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    const StrayMirrors<double> mirrors{.sensor = 0.3, .blades = 0.1};
    const TraceLens<double>& first = at.at(0);
    Fates fates;
    for (const GhostPath& path : some_paths(static_cast<int>(lens.surfaces.size()))) {
        for (int i = 0; i < 10; ++i) {
            FollowedRays given;
            for (TracedRay<double>& ray : given.ray) {
                const double angle = steepest * unit(random);
                const Vec3d direction = normalized(Vec3d{0.1 * unit(random), std::sin(angle), std::cos(angle)});
                const double reach = 1.2 * lens.surfaces.front().semi_diameter;
                ray.ray = {Vec3d{reach * unit(random), reach * unit(random), 0.0} - 40.0 * direction, direction};
            }
            for (const SimdLevel level : available_simd_levels()) {
                FollowedRays together = given;
                follow_ghost_rays(at, path, mirrors, together, level);
                int arrived = 0;
                for (std::size_t lane = 0; lane < kFollowedRays; ++lane) {
                    WorstLimit worst;
                    const TracedRay<double> alone = follow_limits(first, path, given.ray[lane].ray, mirrors,
                                                                  [&](const GhostLimit& limit) { worst.meet(limit); });
                    EXPECT_EQ(together.ray[lane].status == RayStatus::ok, gets_through(alone.status));
                    EXPECT_EQ(together.worst[lane].others, worst.others) << simd_name(level);
                    EXPECT_EQ(together.worst[lane].ratio_squared, worst.ratio_squared) << simd_name(level);
                    if (gets_through(alone.status)) {
                        EXPECT_EQ(together.ray[lane].ray.origin, alone.ray.origin) << simd_name(level);
                        EXPECT_EQ(together.ray[lane].ray.direction, alone.ray.direction) << simd_name(level);
                        EXPECT_EQ(together.ray[lane].transmittance, alone.transmittance) << simd_name(level);
                        ++arrived;
                    }
                }
                if (level == SimdLevel::scalar) {
                    fates.arrived += arrived;
                    fates.ended += static_cast<int>(kFollowedRays) - arrived;
                }
            }
        }
    }
    return fates;
}

SpectralLens<double> at_three(const Lens& lens) {
    return at_wavelengths<double>(lens, {400.0, 550.0, 700.0});
}

TEST(GhostLanes, HaveTheBitsOfTheScalar) {
    Fates seen;
    for (const char* name : {"tessar", "petzval", "muller-fisheye", "double-gauss-tronnier"}) {
        const Lens lens = formats::load_lens(name);
        const Fates fates = compare(lens, at_three(lens), name[0] == 'm' ? 1.5 : 0.5);
        EXPECT_GT(fates.arrived, 10) << name;
        EXPECT_GT(compare_followed(lens, at_three(lens), name[0] == 'm' ? 1.5 : 0.5).arrived, 10) << name;
        seen = {seen.arrived + fates.arrived, seen.ended + fates.ended, seen.parted + fates.parted};
    }
    EXPECT_GT(seen.arrived, 300);
    EXPECT_GT(seen.ended, 300);
    EXPECT_GT(seen.parted, 15);
}

// Blades, which reflect too, coatings, and groups that are turned and displaced.
TEST(GhostLanes, PassWhateverSurfacesHave) {
    for (const Lens& lens : varied_tessars()) {
        const SpectralLens<double> at = at_three(lens);
        ASSERT_FALSE(at.at(0).specials.empty());
        EXPECT_GT(compare(lens, at, 0.4).arrived, 75);
        EXPECT_GT(compare_followed(lens, at, 0.4).arrived, 75);
    }
}

TEST(GhostLanes, PassEveryKindOfCoating) {
    const Lens lens = formats::load_lens("tessar");
    const SpectralLens<double> at(coated_by_turns(at_three(lens).at()));
    EXPECT_GT(compare(lens, at, 0.4).arrived, 75);
    EXPECT_GT(compare_followed(lens, at, 0.4).arrived, 75);
}

// Aspheric, displaced, and of glass that absorbs one colour.
TEST(GhostLanes, PassShapesAndGlassThatAbsorbs) {
    const Lens lens = formats::load_lens("tessar");
    std::vector<TraceLens<double>> at = at_three(lens).at();
    for (TraceLens<double>& one : at) {
        SpecialSurface<double> special;
        special.has_shape = true;
        special.shape = {.curvature = one.surfaces[2].curvature, .conic = -0.5, .asphere = {0.0, 1e-6}, .terms = 2};
        special.vertex = {0.0, 0.3};
        one.specials.push_back(special);
        one.surfaces[2].special = 0;
    }
    at[1].attenuation.assign(lens.surfaces.size() + 1, 0.02);
    EXPECT_GT(compare(lens, SpectralLens<double>(at), 0.4).arrived, 75);
    EXPECT_GT(compare_followed(lens, SpectralLens<double>({at[1]}), 0.4).arrived, 75);
}

}  // namespace lensproof::optics::ghost_lanes_test
