// Chief rays: where the stop is a glass surface, at the ends of the field, through displaced lenses.
#include "engine/optics/chief_ray.h"

#include <gtest/gtest.h>

#include <cmath>

#include "engine/base/angle.h"
#include "engine/base/infinity.h"
#include "engine/formats/prescription/load_lens.h"
#include "engine/optics/field_bundle.h"
#include "engine/spectral/wavelengths.h"

namespace lensproof::optics::chief_ray_test {

/// A biconvex lens whose front is the stop, or has the stop in its vertex's plane just before it.
Prescription singlet(bool front_is_stop) {
    PrescribedSurface front{.radius_mm = 60.0, .thickness_mm = 8.0, .semi_diameter_mm = 5.0, .medium = {.n_d = 1.6}};
    front.is_stop = front_is_stop;
    const PrescribedSurface rear{.radius_mm = -80.0, .thickness_mm = 55.0, .semi_diameter_mm = 20.0};
    Prescription prescription;
    prescription.surfaces = {front, rear};
    if (!front_is_stop) {
        const PrescribedSurface stop{.semi_diameter_mm = 5.0, .is_stop = true};
        prescription.surfaces.insert(prescription.surfaces.begin(), stop);
    }
    return prescription;
}

// The stop's centre is the vertex in both, so that the chief rays are the same.
TEST(ChiefRays, BendAtAStopOfGlass) {
    const ChiefRays on_glass(make_lens(singlet(true), GlassCatalogue{}), spectral::kLineD);
    const ChiefRays in_air(make_lens(singlet(false), GlassCatalogue{}), spectral::kLineD);
    for (const double field : {0.0, 0.1, 0.3, 0.5}) {
        const auto a = on_glass.at_field(field);
        const auto b = in_air.at_field(field);
        ASSERT_TRUE(a && b);
        EXPECT_NEAR(a->field_angle, field, 1e-14);
        EXPECT_NEAR(a->image_height, b->image_height, 1e-12);
    }
}

/// How far from the stop's centre the ray meets the stop.
double miss_at_stop(const Lens& lens, const Ray<double>& ray) {
    const int stop = lens.stop_index();
    const LensSurface& surface = lens.surfaces[stop];
    double miss = kInfinity;
    trace<Direction::forward, Rims::follow>(
        at_wavelength<double>(lens, spectral::kLineD), ray, [&](const SurfaceEvent<double>& event) {
            if (event.surface == stop) {
                const Vec3d& at = event.ray.origin;
                miss = length(at - Vec3d{surface.vertex.x, surface.vertex.y, surface.vertex_z});
            }
        });
    return miss;
}

// On the axis exactly, beside it, at 90° and behind the lens. The angle to 1e-12, and so the path to the stop: where
// the fisheye's front makes an angle of 1e-12 a miss of 1e-12 times the path (some 200 mm).
TEST(ChiefRays, ReachEveryFieldOfAFisheye) {
    const Lens lens = formats::load_lens("fisheye-220");
    const ChiefRays rays(lens, spectral::kLineD);
    ASSERT_GT(rays.largest_field(), 110.0 * kDegree);
    for (const double degrees : {0.0, 1e-9, 1.0, 60.0, 90.0, 105.0, 110.0}) {
        const double field = degrees * kDegree;
        const auto ray = rays.at_field(field);
        ASSERT_TRUE(ray) << degrees;
        EXPECT_NEAR(ray->field_angle, field, 1e-12);
        EXPECT_LT(miss_at_stop(lens, ray->front), 1e-11) << degrees;
        EXPECT_EQ(ray->image_point, (Vec2d{0.0, ray->image_height}));
        EXPECT_EQ(ray->image_height == 0.0, degrees == 0.0);
        const auto below = rays.at_field(-field);
        ASSERT_TRUE(below) << degrees;
        EXPECT_EQ(below->image_height, -ray->image_height);
        EXPECT_EQ(below->front.origin.y, -ray->front.origin.y);
    }
    EXPECT_FALSE(rays.at_field(rays.largest_field() + 1e-3));
}

// Followed past the rims, a triplet's chief rays turn back before they end; the fields up to the turn are all there,
// and those within the rims the same as without following.
TEST(ChiefRays, FollowedUpToTheFold) {
    for (const char* name : {"triplet-cooke", "tessar", "muller-fisheye"}) {
        const Lens lens = formats::load_lens(name);
        const ChiefRays within(lens, spectral::kLineD);
        const ChiefRays beyond(lens, spectral::kLineD, Rims::follow);
        EXPECT_GT(beyond.largest_field(), within.largest_field()) << name;
        for (const double fraction : {0.1, 0.5, 0.99}) {
            const auto ray = beyond.at_field(fraction * beyond.largest_field());
            ASSERT_TRUE(ray) << name;
            EXPECT_LT(miss_at_stop(lens, ray->front), 1e-10);
            const auto same = beyond.at_field(fraction * within.largest_field());
            ASSERT_TRUE(same) << name;
            EXPECT_EQ(same->status, RayStatus::ok);
            EXPECT_NEAR(same->image_height, within.at_field(fraction * within.largest_field())->image_height, 1e-12);
        }
    }
}

// A turned lens's chief rays are those of the straight lens, turned; turned out of the plane x = 0 they still come from
// where they are asked to and meet the stop's centre. 1e-11 mm: angles to 1e-12 over a lens of about 60 mm.
TEST(ChiefRays, AimThroughATurnedLens) {
    constexpr double kTilt = 4.0;
    const Prescription straight = singlet(false);
    for (const bool about_x : {true, false}) {
        Prescription turned = straight;
        turned.groups = {
            {.first = 1, .last = 3, .misalignment = {.tilt_deg = {about_x ? kTilt : 0.0, about_x ? 0.0 : kTilt, 0.0}}}};
        const Lens lens = make_lens(turned, GlassCatalogue{});
        const ChiefRays rays(lens, spectral::kLineD);
        const ChiefRays straight_rays(make_lens(straight, GlassCatalogue{}), spectral::kLineD);
        for (const double field : {-0.2, 0.0, 0.1, 0.3}) {
            const auto ray = rays.at_field(field);
            ASSERT_TRUE(ray) << field;
            EXPECT_NEAR(ray->field_angle, field, 1e-12);
            EXPECT_NEAR(ray->front.direction.x, 0.0, 1e-12);
            EXPECT_LT(miss_at_stop(lens, ray->front), 1e-11);
            // The ray in the lens's own frame lies in some meridional plane, under the angle between it and the axis.
            const Vec3d& axis = lens.surfaces.front().axes[2];
            const double own_field = std::acos(dot(axis, ray->front.direction));
            const auto own = straight_rays.at_field(own_field);
            ASSERT_TRUE(own);
            EXPECT_NEAR(dot(axis, ray->rear.direction), own->rear.direction.z, 1e-12);
            EXPECT_NEAR(length(cross(axis, ray->rear.origin)), std::abs(own->rear.origin.y), 1e-11);
        }
    }
}

// A decentred element, an object at infinity and one nearby.
TEST(ChiefRays, AimThroughADecentredElement) {
    Prescription prescription = singlet(false);
    prescription.surfaces[1].misalignment = {.decentre_mm = {0.4, -0.3}, .tilt_deg = {1.0, -2.0, 30.0}};
    const Lens lens = make_lens(prescription, GlassCatalogue{});
    const ChiefRays rays(lens, spectral::kLineD);
    const ChiefRays other(lens, spectral::kLineF);
    for (const double field : {-0.3, 0.0, 0.2}) {
        const auto far = same_object(field_bundle(rays, field).value(), other);
        ASSERT_TRUE(far);
        EXPECT_NEAR(far->chief.field_angle, field, 1e-12);
        EXPECT_LT(miss_at_stop(lens, far->chief.front), 1e-11);
        const auto near = field_bundle(rays, field, 500.0);
        const auto same = rays.from_point(near->object_point());
        ASSERT_TRUE(near && same);
        EXPECT_LT(length(same->front.origin - near->chief.front.origin), 1e-11);
        EXPECT_NEAR(same->image_point.x, near->chief.image_point.x, 1e-10);
        EXPECT_NE(same->image_point.x, 0.0);
    }
}

}  // namespace lensproof::optics::chief_ray_test
