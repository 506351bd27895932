// Ghosts in first order: against real rays close to the axis, against matrices of the unfolded system, and closed
// forms.
#include "engine/optics/paraxial_ghost.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "engine/base/infinity.h"
#include "engine/formats/prescription/load_lens.h"
#include "engine/optics/convert_lens.h"
#include "engine/optics/lens.h"

namespace lensproof::optics::paraxial_ghost_test {

constexpr double kWavelength = 587.5618;

/// All pairs but those of the stop's blades, which no ray near the axis meets.
std::vector<GhostPath> pairs(const TraceLens<double>& lens, bool with_sensor) {
    std::vector<GhostPath> paths;
    const int surfaces = static_cast<int>(lens.surfaces.size());
    const auto is_mirror = [&](int i) { return i == surfaces || !reflects_by_blades(lens.surfaces[i]); };
    for (int a = 1; a < surfaces + (with_sensor ? 1 : 0); ++a) {
        for (int b = 0; b < a; ++b) {
            if (is_mirror(a) && is_mirror(b)) {
                paths.push_back({a, b});
            }
        }
    }
    return paths;
}

/// Height and slope dy/dz where a real ray of the ghost meets the image plane; past the rims.
struct Arrival {
    long double height;
    long double slope;
};

Arrival arrival(const TraceLens<long double>& lens, const GhostPath& path, long double height, long double slope) {
    const Vec3<long double> direction = normalized(Vec3<long double>{0.0L, slope, 1.0L});
    const auto out = trace_ghost<Direction::forward, Rims::follow>(
        lens, path, Ray<long double>{{0.0L, height, lens.surfaces.front().vertex_z}, direction}, {1.0L, 1.0L});
    const PlanePoint<long double> image = meet_plane(out.ray, lens.image_z);
    return {image.point.y, out.ray.direction.y / out.ray.direction.z};
}

// Real rays h beside the axis depart from the paraxial ones by a part that falls with h²: what halving h changes is
// three times the error that is left, so that half of it bounds that error with room, but for the rounding of long
// doubles over h.
TEST(ParaxialGhost, IsTheLimitOfRealRays) {
    for (const char* name : {"tessar", "heliar-tronnier", "muller-fisheye"}) {
        const TraceLens<double> lens = at_wavelength<double>(formats::load_lens(name), kWavelength);
        const TraceLens<long double> wide = convert_lens<long double>(lens);
        for (const GhostPath& path : pairs(lens, true)) {
            const RayTransfer<double> matrix = folded_system(lens, path).to_image;
            const auto expect_limit = [&](bool parallel, double height, double slope) {
                // As wide as keeps the ray near the axis on its way, too.
                constexpr long double kBeside = 1e-5L;
                const auto at = [&](long double beside) {
                    const Arrival a = arrival(wide, path, parallel ? beside : 0.0L, parallel ? 0.0L : beside);
                    return Arrival{a.height / beside, a.slope / beside};
                };
                const Arrival one = at(kBeside);
                const Arrival two = at(2.0L * kBeside);
                const double size = 1.0 + std::abs(height) + std::abs(slope);
                EXPECT_NEAR(static_cast<double>(one.height), height,
                            static_cast<double>(std::abs(two.height - one.height)) / 2.0 + 1e-12 * size);
                EXPECT_NEAR(static_cast<double>(one.slope), slope,
                            static_cast<double>(std::abs(two.slope - one.slope)) / 2.0 + 1e-12 * size);
            };
            SCOPED_TRACE(std::string(name) + " " + std::to_string(path[0] + 1) + "," + std::to_string(path[1] + 1));
            expect_limit(true, matrix.a, matrix.c);
            expect_limit(false, matrix.b, matrix.d);
        }
    }
}

// The unfolded system, as flare renderers have it: distances all positive, radii turned round where light runs back, a
// mirror as a lens of power 2 n c (Lee & Eisemann 2013, §3), slopes along the light and multiplied by the index.
struct Unfolded {
    double a = 1.0, b = 0.0, c = 0.0, d = 1.0;
    void cross(double reduced) {
        a += reduced * c;
        b += reduced * d;
    }
    void power(double phi) {
        c -= phi * a;
        d -= phi * b;
    }
};

Unfolded unfolded(const TraceLens<double>& lens, const GhostPath& path) {
    Unfolded m;
    const int last = static_cast<int>(lens.surfaces.size()) - 1;
    const auto& s = lens.surfaces;
    const auto gap = [&](int i) { return (s[i + 1].vertex_z - s[i].vertex_z) / s[i].index_after; };
    const auto refraction = [&](int i) { return s[i].curvature * (s[i].index_after - s[i].index_before); };
    for (int i = 0; i < path[0]; ++i) {
        m.power(refraction(i));
        m.cross(gap(i));
    }
    m.power(-2.0 * s[path[0]].index_before * s[path[0]].curvature);
    for (int i = path[0] - 1; i > path[1]; --i) {
        m.cross(gap(i));
        m.power(refraction(i));  // turned round, and its media exchanged: the same power
    }
    m.cross(gap(path[1]));
    m.power(2.0 * s[path[1]].index_after * s[path[1]].curvature);
    for (int i = path[1] + 1; i <= last; ++i) {
        m.cross(gap(i - 1));
        m.power(refraction(i));
    }
    m.cross(lens.image_z - s[last].vertex_z);
    return m;
}

// Some forty products and sums each: 1e-13 of the largest that may have cancelled, which on the way is no more than 1e3
// times what is left here.
TEST(ParaxialGhost, IsThatOfTheUnfoldedSystem) {
    for (const char* name : {"tessar", "heliar-tronnier", "muller-fisheye"}) {
        const TraceLens<double> lens = at_wavelength<double>(formats::load_lens(name), kWavelength);
        for (const GhostPath& path : pairs(lens, false)) {
            const RayTransfer<double> folded = folded_system(lens, path).to_image;
            const Unfolded m = unfolded(lens, path);
            const double size = 1e-10 * (std::abs(m.a) + std::abs(m.b) + std::abs(m.c) + std::abs(m.d));
            EXPECT_NEAR(folded.a, m.a, size);
            EXPECT_NEAR(folded.b, m.b, size);
            EXPECT_NEAR(folded.c, m.c, size);
            EXPECT_NEAR(folded.d, m.d, size);
            EXPECT_NEAR(folded.a * folded.d - folded.b * folded.c, 1.0, 1e-10 * (1.0 + std::abs(m.a * m.d)));
            const ParaxialGhost ghost = paraxial_ghost(lens, path, 0.1);
            EXPECT_NEAR(ghost.efl * m.c, -1.0, 1e-9);
            EXPECT_NEAR(ghost.focus * m.c, -m.a, 1e-9 * (1.0 + std::abs(m.a)));
            EXPECT_NEAR(ghost.marginal_ray_height, 0.5 * paraxial_data(lens).entrance_pupil_diameter * m.a,
                        1e-9 * (1.0 + std::abs(m.a)) * 50.0);
        }
    }
}

// A ghost of no reflections is the lens itself.
TEST(ParaxialGhost, WithoutReflectionsIsTheLens) {
    const TraceLens<double> lens = at_wavelength<double>(formats::load_lens("tessar"), kWavelength);
    const ParaxialData data = paraxial_data(lens);
    const ParaxialGhost image = paraxial_ghost(lens, {}, 0.2);
    EXPECT_NEAR(image.efl, data.efl, 1e-12 * data.efl);
    EXPECT_NEAR(image.f_number, data.f_number, 1e-12 * data.f_number);
    const double image_distance = lens.image_z - lens.surfaces.back().vertex_z;
    EXPECT_NEAR(image.focus, data.bfl - image_distance, 1e-12 * data.efl);
    EXPECT_NEAR(image.pupil, data.exit_pupil_z - image_distance, 1e-11 * data.efl);
    const auto chief = paraxial_chief_ray(lens, 0.2);
    const auto rear = trace_paraxial(lens, *chief, 0, static_cast<int>(lens.surfaces.size()) - 1);
    EXPECT_NEAR(image.chief_ray_height.value(), rear.height + image_distance * rear.slope, 1e-12 * data.efl);
}

// Behind the reflections light passes the stop as ever, so the pupil is the lens's exit pupil where both lie before it;
// the chief ray really passes the stop's centre on its last way through.
TEST(ParaxialGhost, ChiefRayPassesTheStopAfterTheReflections) {
    const TraceLens<double> lens = at_wavelength<double>(formats::load_lens("tessar"), kWavelength);
    const int stop = paraxial_detail::find_stop(lens);
    const double image_distance = lens.image_z - lens.surfaces.back().vertex_z;
    for (const GhostPath& path : pairs(lens, true)) {
        const ParaxialGhost ghost = paraxial_ghost(lens, path, 0.1);
        if (path[0] <= stop) {
            EXPECT_NEAR(ghost.pupil, paraxial_data(lens).exit_pupil_z - image_distance, 1e-8);
        }
        // A real ray of that aim, close to the axis: heights on the stop against those elsewhere.
        const FoldedSystem<double> system = folded_system(lens, path);
        constexpr double kSlope = 1e-6;
        const double height = -system.to_stop.b / system.to_stop.a * kSlope;
        double at_stop = kInfinity;
        trace_ghost<Direction::forward, Rims::follow>(
            lens, path, Ray<double>{{0.0, height, 0.0}, normalized(Vec3d{0.0, kSlope, 1.0})}, {1.0, 1.0},
            [&](const SurfaceEvent<double>& event) {
                at_stop = event.surface == stop && event.ray.direction.z > 0.0 ? event.ray.origin.y : at_stop;
            });
        EXPECT_LT(std::abs(at_stop), 1e-8 * (1.0 + std::abs(height) / kSlope) * 1e-3);
    }
}

// A plate between parallel faces shifts foci by its returns and focuses nothing.
TEST(ParaxialGhost, PlateHasNoFocus) {
    TraceLens<double> plate{.surfaces = {make_trace_surface(0.0, 0.0, 10.0, 1.0, 1.5, true),
                                         make_trace_surface(0.0, 3.0, 10.0, 1.5, 1.0, false)},
                            .image_z = 50.0};
    const RayTransfer<double> matrix = folded_system(plate, {1, 0}).to_image;
    EXPECT_EQ(matrix.a, 1.0);
    EXPECT_EQ(matrix.c, 0.0);
    EXPECT_NEAR(matrix.b, 3 * 3.0 / 1.5 + 47.0, 1e-13);
    const ParaxialGhost ghost = paraxial_ghost(plate, {1, 0}, 0.0);
    EXPECT_TRUE(std::isinf(ghost.efl));
    EXPECT_TRUE(std::isinf(ghost.focus));
    EXPECT_EQ(ghost.marginal_ray_height, 10.0);
}

}  // namespace lensproof::optics::paraxial_ghost_test
