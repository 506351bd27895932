// Mirrors in the sequence of surfaces, against closed forms and against reflection written out in space.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/base/input_error.h"
#include "engine/optics/focus.h"
#include "engine/optics/lens.h"
#include "engine/optics/paraxial.h"
#include "engine/optics/polarised_ray.h"
#include "tests/complaint.h"

namespace lensproof::optics::mirror_test {

constexpr double kGreen = 546.074;

PrescribedSurface mirror(double radius_mm, double conic, double thickness_mm, double semi_diameter_mm) {
    return {.radius_mm = radius_mm,
            .conic = conic,
            .thickness_mm = thickness_mm,
            .semi_diameter_mm = semi_diameter_mm,
            .medium = {},
            .is_mirror = true};
}

/// A paraboloid of f = 500 mm at f/5, alone and its own stop.
Prescription paraboloid() {
    Prescription prescription{.name = "paraboloid", .surfaces = {mirror(-1000.0, -1.0, -500.0, 50.0)}};
    prescription.surfaces.front().is_stop = true;
    return prescription;
}

/// Cassegrain's telescope: a paraboloid of f = 500 mm and, 350 mm in front of it, a hyperboloid of magnification
/// m = 4, which images the primary's focus, 150 mm behind it, to 600 mm behind itself: 1/s' − 1/s = 2/R makes
/// R = −400 mm, and its conic constant is −((m + 1) / (m − 1))² (Schroeder, Astronomical Optics, §2.5 and §4.2).
Prescription cassegrain() {
    Prescription prescription = paraboloid();
    prescription.name = "Cassegrain";
    prescription.surfaces.front().thickness_mm = -350.0;
    prescription.surfaces.push_back(mirror(-400.0, -25.0 / 9.0, 600.0, 20.0));
    return prescription;
}

/// Mangin's mirror: a negative meniscus of glass, silvered behind.
Prescription mangin() {
    StatedMedium glass;
    glass.n_d = 1.5168;
    Prescription prescription{
        .name = "Mangin",
        .surfaces = {
            {.radius_mm = -150.0, .thickness_mm = 8.0, .semi_diameter_mm = 30.0, .medium = glass, .is_stop = true},
            mirror(-240.0, 0.0, -8.0, 31.0),
            {.radius_mm = -150.0, .thickness_mm = -160.0, .semi_diameter_mm = 30.0, .medium = {}}}};
    set_mirror_media(prescription.surfaces);
    return prescription;
}

TraceLens<double> traced(const Prescription& prescription) {
    return at_wavelength<double>(make_lens(prescription, {}), kGreen);
}

Ray<double> along_axis(double x, double y) {
    return {{x, y, -800.0}, {0.0, 0.0, 1.0}};
}

// All light from far off meets in the focus, over the same path: 800 mm in and f back, counted from the vertex.
TEST(Mirror, AParaboloidIsStigmatic) {
    const TraceLens<double> lens = traced(paraboloid());
    for (const double y : {-50.0, -20.0, 1e-3, 35.0, 50.0}) {
        const TracedRay<double> ray = trace(lens, along_axis(0.3 * y, 0.9 * y));
        ASSERT_EQ(ray.status, RayStatus::ok);
        const PlanePoint<double> image = meet_plane(ray.ray, lens.image_z);
        EXPECT_NEAR(image.point.x, 0.0, 1e-12);
        EXPECT_NEAR(image.point.y, 0.0, 1e-12);
        EXPECT_NEAR(ray.optical_path + lens.surfaces.back().index_after * image.distance, 1300.0, 1e-12 * 1300.0);
        EXPECT_EQ(ray.transmittance, 1.0);
    }
}

TEST(Mirror, HasPositivePowerWhereItIsConcave) {
    const ParaxialData data = paraxial_data(traced(paraboloid()));
    EXPECT_DOUBLE_EQ(data.efl, 500.0);
    EXPECT_DOUBLE_EQ(data.front_efl, 500.0);
    EXPECT_DOUBLE_EQ(data.bfl, -500.0);
    EXPECT_DOUBLE_EQ(data.f_number, 5.0);
    // With the stop at its centre of curvature a sphere images without astigmatism onto a sphere about that centre.
    EXPECT_DOUBLE_EQ(data.petzval_radius, -500.0);
    // An object at the centre of curvature is its own image, upside down.
    const Conjugates at_centre = paraxial_conjugates(traced(paraboloid()), 1000.0);
    EXPECT_DOUBLE_EQ(at_centre.image_distance, -1000.0);
    EXPECT_DOUBLE_EQ(at_centre.magnification, -1.0);
}

TEST(Mirror, TwoMakeCassegrainsTelescope) {
    const TraceLens<double> lens = traced(cassegrain());
    const ParaxialData data = paraxial_data(lens);
    EXPECT_NEAR(data.efl, 2000.0, 1e-9);
    EXPECT_NEAR(data.bfl, 600.0, 1e-9);
    const double axial = trace(lens, along_axis(0.0, 1e-6)).optical_path;
    for (const double y : {20.0, 35.0, 50.0}) {
        const TracedRay<double> ray = trace(lens, along_axis(0.0, y));
        ASSERT_EQ(ray.status, RayStatus::ok);
        const PlanePoint<double> image = meet_plane(ray.ray, lens.image_z);
        EXPECT_NEAR(image.point.y, 0.0, 1e-11);
        EXPECT_NEAR(ray.optical_path + image.distance, axial + 600.0, 1e-9);
        EXPECT_GT(ray.ray.direction.z, 0.0);
    }
}

/// Where a ray meets a sphere with its vertex at z; the crossing near the vertex, whichever way the ray runs.
Vec3d on_sphere(const Ray<double>& ray, double vertex_z, double radius) {
    const Vec3d from_centre = ray.origin - Vec3d{0.0, 0.0, vertex_z + radius};
    const double b = dot(from_centre, ray.direction);
    const double root = std::sqrt(b * b - dot(from_centre, from_centre) + radius * radius);
    const Vec3d near = ray.origin + (-b - root) * ray.direction;
    const Vec3d far = ray.origin + (-b + root) * ray.direction;
    return std::abs(near.z - vertex_z) < std::abs(far.z - vertex_z) ? near : far;
}

Vec3d bent(const Vec3d& direction, Vec3d normal, double ratio) {
    normal = dot(direction, normal) < 0.0 ? -1.0 * normal : normal;
    const double cosine = dot(direction, normal);
    return ratio * direction + (std::sqrt(1.0 - ratio * ratio * (1.0 - cosine * cosine)) - ratio * cosine) * normal;
}

// In space, with directions that light travels in: refraction, reflection d − 2 (d·n) n, refraction.
TEST(Mirror, BehindGlassIsReflectionInSpace) {
    const TraceLens<double> lens = traced(mangin());
    const double n = 1.5168;
    for (const Vec3d& start : {Vec3d{3.0, 25.0, -50.0}, Vec3d{-10.0, 5.0, -50.0}}) {
        Ray<double> ray{start, normalized(Vec3d{0.02, -0.05, 1.0})};
        const TracedRay<double> sequential = trace(lens, ray);
        ASSERT_EQ(sequential.status, RayStatus::ok);
        double path = 0.0;
        const auto go_on = [&](double vertex_z, double radius, double index) {
            const Vec3d point = on_sphere(ray, vertex_z, radius);
            path += index * length(point - ray.origin);
            ray.origin = point;
            return (1.0 / radius) * (point - Vec3d{0.0, 0.0, vertex_z + radius});
        };
        ray.direction = bent(ray.direction, go_on(0.0, -150.0, 1.0), 1.0 / n);
        const Vec3d normal = go_on(8.0, -240.0, n);
        ray.direction = ray.direction - 2.0 * dot(ray.direction, normal) * normal;
        ray.direction = bent(ray.direction, go_on(0.0, -150.0, n), n);
        EXPECT_NEAR(length(sequential.ray.origin - ray.origin), 0.0, 1e-12);
        EXPECT_NEAR(length(sequential.ray.direction + ray.direction), 0.0, 1e-14);  // n < 0: light runs against it
        EXPECT_NEAR(sequential.optical_path, path, 1e-12);
    }
}

TEST(Mirror, IsTracedBackTheSameWay) {
    for (const Prescription& prescription : {paraboloid(), cassegrain(), mangin()}) {
        const TraceLens<double> lens = traced(prescription);
        const Ray<double> ray{{4.0, 20.0, -60.0}, normalized(Vec3d{0.01, -0.02, 1.0})};
        const TracedRay<double> there = trace(lens, ray);
        const PlanePoint<double> image = meet_plane(there.ray, lens.image_z);
        const TracedRay<double> back =
            trace<Direction::reverse>(lens, Ray<double>{image.point, -1.0 * there.ray.direction});
        ASSERT_EQ(back.status, RayStatus::ok) << prescription.name;
        EXPECT_NEAR(length(back.ray.direction + ray.direction), 0.0, 1e-13);
        EXPECT_NEAR(length(meet_plane(back.ray, -60.0).point - ray.origin), 0.0, 1e-11);
        EXPECT_NEAR(back.transmittance, there.transmittance, 1e-14);
    }
}

TEST(Mirror, KeepsWhatItsReflectanceSays) {
    Prescription prescription = cassegrain();
    prescription.coatings["aluminium"] = std::vector<WavelengthValue>{{400.0, 0.92}, {700.0, 0.90}};
    prescription.surfaces[0].coating = "aluminium";
    prescription.surfaces[1].coating = "aluminium";
    const double reflectance = 0.92 - 0.02 * (kGreen - 400.0) / 300.0;
    EXPECT_NEAR(trace(traced(prescription), along_axis(0.0, 30.0)).transmittance, reflectance * reflectance, 1e-14);
}

// Unpolarised light stays so: metal's difference between s and p is not modelled, and the frame is turned rightly.
TEST(Mirror, LeavesPolarisationAsItIs) {
    const TraceLens<double> lens = traced(cassegrain());
    const Ray<double> ray = along_axis(20.0, 30.0);
    PolarisedEvents<double> polarised(lens, {}, ray.direction, Direction::forward, Rims::clip);
    trace(lens, ray, [&](const SurfaceEvent<double>& event) { polarised(event); });
    EXPECT_NEAR(polarised.factor(), 1.0, 1e-14);
}

TEST(Mirror, FocusesOnAnObject) {
    const Lens lens = focused_at(make_lens(paraboloid(), {}), 1500.0);
    EXPECT_NEAR(lens.image_z, -750.0, 1e-9);  // 1/s' = 1/500 − 1/1500
}

TEST(Mirror, WhatIsNoneOfThemIsRefused) {
    Prescription forwards = cassegrain();
    forwards.surfaces.front().thickness_mm *= -1.0;
    EXPECT_TRUE(says(lensproof::complaint_about([&] { make_lens(forwards, {}); }), "behind a mirror"));
    Prescription two_media = paraboloid();
    two_media.surfaces.front().medium.n_d = 1.5;
    EXPECT_TRUE(
        says(lensproof::complaint_about([&] { make_lens(two_media, {}); }), "expected what is in front of it, air"));
    Prescription layered = paraboloid();
    layered.coatings["stack"] = LayerStack{};
    layered.surfaces.front().coating = "stack";
    EXPECT_TRUE(says(lensproof::complaint_about([&] { make_lens(layered, {}); }), "expected a reflectance"));
}

}  // namespace lensproof::optics::mirror_test
