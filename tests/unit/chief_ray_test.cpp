// Chief rays where the stop is a glass surface.
#include "engine/optics/chief_ray.h"

#include <gtest/gtest.h>

#include <cmath>

#include "engine/spectral/wavelengths.h"

namespace lensproof {
namespace {

/// A biconvex lens whose front is the stop, or has the stop in its vertex's plane just before it.
Prescription singlet(bool front_is_stop) {
    PrescribedSurface front{.radius_mm = 60.0, .thickness_mm = 8.0, .semi_diameter_mm = 5.0};
    front.medium.n_d = 1.6;
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
    const ChiefRays on_glass(make_lens(singlet(true), GlassCatalogue{}), kLineD);
    const ChiefRays in_air(make_lens(singlet(false), GlassCatalogue{}), kLineD);
    for (const double field : {0.0, 0.1, 0.3, 0.5}) {
        const auto a = on_glass.at_field(field);
        const auto b = in_air.at_field(field);
        ASSERT_TRUE(a && b);
        EXPECT_NEAR(a->field_angle, field, 1e-14);
        EXPECT_NEAR(a->image_height, b->image_height, 1e-12);
    }
}

}  // namespace
}  // namespace lensproof
