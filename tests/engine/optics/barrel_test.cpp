// Light between the walls of a lens: against molecular flow's closed form, the second law and energy's conservation.
#include "engine/optics/barrel.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>
#include <random>
#include <string>

#include "engine/base/input_error.h"
#include "engine/optics/stray_walk.h"
#include "engine/optics/wall_finish.h"

namespace lensproof::optics::barrel_test {

constexpr double kWavelength = 587.5618;
constexpr double kPi = std::numbers::pi;
constexpr WallFinish kWhite{.albedo = 1.0};
constexpr WallFinish kGlossyWhite{.albedo = 1.0, .gloss = 0.6, .roughness = 0.4};

class Numbers {
  public:
    explicit Numbers(std::uint64_t seed) : random_(seed) {}
    double operator()() { return uniform_(random_); }
    Vec2d on_disc(double radius) {
        const double r = radius * std::sqrt((*this)());
        const double azimuth = 2.0 * kPi * (*this)();
        return {r * std::cos(azimuth), r * std::sin(azimuth)};
    }

  private:
    std::mt19937_64 random_;
    std::uniform_real_distribution<double> uniform_{0.0, 1.0};
};

/// Numbers about a mean, with its standard error.
struct Mean {
    int count = 0;
    double sum = 0.0;
    double squares = 0.0;

    void add(double value) {
        ++count;
        sum += value;
        squares += value * value;
    }
    [[nodiscard]] double mean() const { return sum / count; }
    [[nodiscard]] double error() const { return std::sqrt((squares / count - mean() * mean()) / (count - 1)); }
};

// Even light from everywhere leaves a wall that keeps it all as even light (a white furnace): whatever the roughness,
// its cosines have Lambert's moments, 2/3 and 1/2. By the second law only what is reciprocal and loses nothing does so.
// Four standard errors.
TEST(WallFinish, WhiteWallsKeepEvenLightEven) {
    for (const double roughness : {0.05, 0.4, 1.0}) {
        SCOPED_TRACE(roughness);
        const WallFinish finish{.albedo = 1.0, .gloss = 0.8, .roughness = roughness};
        Numbers numbers(3);
        Mean cosine;
        Mean squared;
        for (int i = 0; i < 100'000; ++i) {
            const Vec3d in = lambert_direction(numbers(), numbers());
            const Vec3d out = scattered_direction(finish, -1.0 * in, numbers);
            ASSERT_GT(out.z, 0.0);
            ASSERT_NEAR(length(out), 1.0, 1e-12);
            cosine.add(out.z);
            squared.add(out.z * out.z);
        }
        EXPECT_NEAR(cosine.mean(), 2.0 / 3.0, 4.0 * cosine.error());
        EXPECT_NEAR(squared.mean(), 0.5, 4.0 * squared.error());
    }
}

// A rough mirror's two directions may be exchanged: of light from one slant the fraction that leaves into a cone about
// another, over that cone's cosines, is as large the other way round.
TEST(WallFinish, RoughMirrorsAreReciprocal) {
    const WallFinish finish{.albedo = 1.0, .gloss = 1.0, .roughness = 0.5};
    const auto fraction = [&](double from, double to) {  // both directions by their cosine, opposite each other
        Numbers numbers(5);
        const Vec3d in{std::sqrt(1.0 - from * from), 0.0, -from};
        const Vec3d towards{std::sqrt(1.0 - to * to), 0.0, to};
        Mean found;
        for (int i = 0; i < 300'000; ++i) {
            const Vec3d out = scattered_direction(finish, in, numbers);
            found.add(dot(out, towards) > 0.99 ? 1.0 / out.z : 0.0);
        }
        return found;
    };
    const Mean there = fraction(0.3, 0.8);
    const Mean back = fraction(0.8, 0.3);
    // The cones are 8° wide: the mean of what is reciprocal over them differs by a few percent.
    EXPECT_NEAR(there.mean(), back.mean(), 4.0 * std::hypot(there.error(), back.error()) + 0.04 * there.mean());
}

TEST(WallFinish, SmoothMirrorsReflect) {
    Numbers numbers(1);
    const Vec3d in = normalized(Vec3d{0.5, 0.2, -0.7});
    const Vec3d out = reflected_by_facets(in, 0.0, numbers);
    EXPECT_NEAR(length(out - Vec3d{in.x, in.y, -in.z}), 0.0, 1e-14);
}

/// A tube in air, open at both ends.
Lens tube(double length, double front_radius, double rear_radius, const WallFinish& walls) {
    Prescription prescription;
    prescription.name = "tube";
    prescription.surfaces = {
        {.thickness_mm = length, .semi_diameter_mm = front_radius},
        {.thickness_mm = 1.0, .semi_diameter_mm = rear_radius, .is_stop = true},
    };
    prescription.surfaces[1].rim_mm = rear_radius;
    prescription.barrel = {.tube = walls, .edges = walls, .blades = walls};
    return make_lens(prescription, {});
}

/// The fraction of light, even over an end and by Lambert's law, that leaves at the other.
Mean transmission(const Lens& lens, bool forward, int rays) {
    const TraceLens<double> at = at_wavelength<double>(lens, kWavelength);
    const Barrel barrel(lens);
    const StrayMirrors<double> mirrors;
    Numbers numbers(7);
    Mean passed;
    for (int i = 0; i < rays; ++i) {
        const LensSurface& end = forward ? lens.surfaces.front() : lens.surfaces.back();
        const Vec2d place = numbers.on_disc(end.semi_diameter);
        Vec3d direction = lambert_direction(numbers(), numbers());
        direction.z *= forward ? 1.0 : -1.0;
        StrayLight light{.ray = {{place.x, place.y, end.vertex_z}, direction}};
        StrayWalk walk(at, barrel, mirrors, numbers);
        const StrayEnd ended = walk.follow(light, forward, [](const StrayLight&) {});
        EXPECT_TRUE(ended == StrayEnd::film || ended == StrayEnd::front);
        EXPECT_EQ(light.weight, 1.0);
        passed.add(ended == (forward ? StrayEnd::film : StrayEnd::front) ? 1.0 : 0.0);
    }
    return passed;
}

// A tube whose walls scatter all light by Lambert's law passes what it passes of a gas so thin that molecules meet
// walls alone (P. Clausing, Ann. Phys. 404, 961, 1932, table to three digits, by length over radius).
TEST(Barrel, WhiteTubePassesWhatClausingSays) {
    for (const auto& [length, passed] : {std::pair{1.0, 0.672}, {2.0, 0.514}, {4.0, 0.357}}) {
        SCOPED_TRACE(length);
        const Mean found = transmission(tube(3.0 * length, 3.0, 3.0, kWhite), true, 40'000);
        EXPECT_NEAR(found.mean(), passed, 4.0 * found.error() + 5e-4);
    }
}

// Even light on both ends of a cone stays in balance: area times fraction is the same both ways, from paint and from
// gloss.
TEST(Barrel, ConesPassAlikeBothWays) {
    for (const WallFinish& walls : {kWhite, kGlossyWhite}) {
        const Lens lens = tube(5.0, 4.0, 2.0, walls);
        const Mean there = transmission(lens, true, 40'000);
        const Mean back = transmission(lens, false, 40'000);
        EXPECT_NEAR(16.0 * there.mean(), 4.0 * back.mean(), 4.0 * std::hypot(16.0 * there.error(), 4.0 * back.error()));
    }
}

/// A flat window, a stop of six blades, a wide singlet and a field lens in one barrel with steps.
Lens stepped_lens(const BarrelFinish& finish) {
    Prescription prescription;
    prescription.name = "stepped";
    prescription.surfaces = {
        {.thickness_mm = 3.0, .semi_diameter_mm = 8.0, .medium = {.n_d = 1.9}},
        {.radius_mm = -60.0, .thickness_mm = 5.0, .semi_diameter_mm = 8.0},
        {.thickness_mm = 4.0, .semi_diameter_mm = 6.0, .is_stop = true},
        {.radius_mm = 40.0, .thickness_mm = 5.0, .semi_diameter_mm = 9.0, .medium = {.n_d = 1.7}},
        {.radius_mm = -40.0, .thickness_mm = 12.0, .semi_diameter_mm = 9.0},
    };
    prescription.surfaces[0].rim_mm = 8.5;
    prescription.surfaces[1].rim_mm = 8.5;
    prescription.surfaces[1].barrel_mm = 10.0;
    prescription.surfaces[3].coating = "single";
    prescription.coatings["single"] = LayerStack{.layers = {{.index = {{550.0, 1.38}}, .quarter_wave_nm = 550.0}}};
    prescription.stop_shape = PolygonStop{.blades = 6};
    prescription.barrel = finish;
    return make_lens(prescription, {});
}

/// Grains and haze on a third of the front.
FrontDust dust(double albedo, double through) {
    return {.covered = std::make_shared<const ApertureTexture>(
                ApertureTexture{.size_x = 3, .size_y = 2, .values = {1.0F, 0.0F, 0.25F, 0.0F, 0.75F, 0.0F}}),
            .semi_diameter = 8.0,
            .albedo = albedo,
            .through = through};
}

struct Fractions {
    Mean image;
    Mean ghosts;
    Mean barrel;

    void add(const StrayLight& light, double value) {
        const bool is_ghost = light.walls == 0 && light.reflections > 0;
        image.add(light.walls == 0 && !is_ghost ? value : 0.0);
        ghosts.add(is_ghost ? value : 0.0);
        barrel.add(light.walls > 0 ? value : 0.0);
    }
};

/// Even light over the flat front, which lands on a disc of the sensor's plane; or over that disc, which leaves at the
/// front: the flux of radiance 1, over π.
Fractions exchanged(const Lens& lens, double film_radius, bool forward, int rays) {
    const TraceLens<double> at = at_wavelength<double>(lens, kWavelength);
    const Barrel barrel(lens);
    const StrayMirrors<double> mirrors{.sensor = 0.8};
    Numbers numbers(forward ? 11 : 12);
    const double radius = forward ? lens.surfaces.front().semi_diameter : film_radius;
    const double area = kPi * radius * radius;
    Fractions fractions;
    for (int i = 0; i < rays; ++i) {
        const Vec2d place = numbers.on_disc(radius);
        Vec3d direction = lambert_direction(numbers(), numbers());
        direction.z *= forward ? 1.0 : -1.0;
        StrayLight light{.ray = {{place.x, place.y, forward ? 0.0 : lens.image_z}, direction}};
        StrayWalk walk(at, barrel, mirrors, numbers);
        bool counts = false;
        const auto landed = [&](const StrayLight& on_film) {
            if (forward && std::hypot(on_film.ray.origin.x, on_film.ray.origin.y) <= film_radius) {
                fractions.add(on_film, area * on_film.weight);
                counts = true;
            }
        };
        const StrayEnd ended = walk.follow(light, forward, landed);
        if (!forward && ended == StrayEnd::front) {
            fractions.add(light, area * light.weight);
        } else if (!counts) {
            fractions.add(light, 0.0);
        }
    }
    for (Mean* mean : {&fractions.image, &fractions.ghosts, &fractions.barrel}) {
        mean->count = rays;  // light that a mirror brings to the sensor twice counts twice, of one ray
    }
    return fractions;
}

void expect_alike(const Fractions& there, const Fractions& back) {
    for (const auto& [name, one, other] : {std::tuple{"image", there.image, back.image},
                                           {"ghosts", there.ghosts, back.ghosts},
                                           {"walls and dust", there.barrel, back.barrel}}) {
        SCOPED_TRACE(name);
        EXPECT_NEAR(one.mean(), other.mean(), 4.0 * std::hypot(one.error(), other.error()));
        EXPECT_LT(one.error(), 0.05 * one.mean());
    }
}

// Light goes both ways alike, in each of its classes: through coated and bare glass, blades, edges, steps of the tube
// and a sensor that is a mirror.
TEST(StrayWalk, EveryClassIsTheSameBothWays) {
    const Lens lens = stepped_lens({.tube = {.albedo = 0.6, .gloss = 0.5, .roughness = 0.3},
                                    .edges = {.albedo = 0.8},
                                    .blades = {.albedo = 0.5, .gloss = 1.0, .roughness = 0.2}});
    expect_alike(exchanged(lens, 6.0, true, 200'000), exchanged(lens, 6.0, false, 200'000));
}

// Dust as well, whose light the glass under it sends back in part: between black walls all of their class is dust's.
TEST(StrayWalk, DustIsTheSameBothWays) {
    Lens lens = stepped_lens({});
    lens.dust = dust(0.9, 0.7);
    expect_alike(exchanged(lens, 6.0, true, 400'000), exchanged(lens, 6.0, false, 400'000));
}

// White walls and clear glass: what enters lands or leaves, all of it, be there dust that absorbs nothing or none.
TEST(StrayWalk, NothingIsLostInAWhiteLens) {
    for (const bool has_dust : {false, true}) {
        Lens lens = stepped_lens({.tube = kGlossyWhite, .edges = kWhite, .blades = kWhite});
        if (has_dust) {
            lens.dust = dust(1.0, 0.5);
        }
        const TraceLens<double> at = at_wavelength<double>(lens, kWavelength);
        const Barrel barrel(lens);
        const StrayMirrors<double> mirrors;
        Numbers numbers(17);
        std::map<StrayEnd, double> energy;
        constexpr int kRays = 30'000;
        for (int i = 0; i < kRays; ++i) {
            const Vec2d place = numbers.on_disc(8.0);
            StrayLight light{.ray = {{place.x, place.y, 0.0}, lambert_direction(numbers(), numbers())}};
            StrayWalk walk(at, barrel, mirrors, numbers);
            energy[walk.follow(light, true, [](const StrayLight&) {})] += light.weight;
        }
        EXPECT_NEAR(energy[StrayEnd::film] + energy[StrayEnd::front] + energy[StrayEnd::body], kRays, 1e-9 * kRays);
        EXPECT_LT(energy[StrayEnd::body], 1e-3 * kRays);  // sideways out of the bulging rear
        EXPECT_GT(energy[StrayEnd::film], 0.3 * kRays);
        EXPECT_GT(energy[StrayEnd::front], 0.1 * kRays);
    }
}

// Black walls leave the image and the ghosts: nothing that lands met one.
TEST(StrayWalk, BlackWallsEndEveryPath) {
    const Fractions there = exchanged(stepped_lens({}), 6.0, true, 20'000);
    EXPECT_GT(there.image.sum, 0.0);
    EXPECT_GT(there.ghosts.sum, 0.0);
    EXPECT_EQ(there.barrel.sum, 0.0);
}

TEST(Barrel, IsOfLensesAboutOneAxis) {
    Prescription prescription;
    prescription.name = "tilted";
    prescription.surfaces = {
        {.thickness_mm = 3.0, .semi_diameter_mm = 8.0, .medium = {.n_d = 1.5}},
        {.thickness_mm = 3.0, .semi_diameter_mm = 8.0, .is_stop = true},
    };
    prescription.surfaces[0].misalignment.tilt_deg = {1.0, 0.0, 0.0};
    EXPECT_NO_THROW(Barrel(make_lens(prescription, {})));  // black
    prescription.barrel.edges.albedo = 0.1;
    EXPECT_THROW(Barrel(make_lens(prescription, {})), InputError);
}

}  // namespace lensproof::optics::barrel_test
