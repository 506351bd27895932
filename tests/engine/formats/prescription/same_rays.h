// tests/engine/formats/prescription/same_rays.h — two prescriptions held to be the same lens, ray by ray.
#pragma once
#include <gtest/gtest.h>

#include "engine/formats/glass/shipped_glasses.h"
#include "engine/optics/glass_catalogue.h"
#include "engine/optics/lens.h"

namespace lensproof::formats {

/// Traces 17 × 7 × 7 rays over field and front at three wavelengths through both: each must end the same way, and reach
/// the sensor within 1e-9 mm.
inline void expect_same_rays(const optics::Prescription& expected, const optics::Prescription& found) {
    const optics::GlassCatalogue glasses = shipped_glasses();
    const optics::Lens first = optics::make_lens(expected, glasses);
    const optics::Lens second = optics::make_lens(found, glasses);
    ASSERT_EQ(first.surfaces.size(), second.surfaces.size());
    EXPECT_NEAR(first.image_z, second.image_z, 1e-10);
    const double radius = first.surfaces.front().semi_diameter;
    int passed = 0;
    for (const double wavelength_nm : {486.1327, 587.5618, 656.2725}) {
        const optics::TraceLens<double> one = optics::at_wavelength<double>(first, wavelength_nm);
        const optics::TraceLens<double> other = optics::at_wavelength<double>(second, wavelength_nm);
        for (int field = -8; field <= 8; ++field) {
            for (int i = -3; i <= 3; ++i) {
                for (int j = -3; j <= 3; ++j) {
                    const Vec3d direction = normalized(Vec3d{0.01 * field, 0.04 * field, 1.0});
                    const Vec3d aim{0.23 * i * radius, 0.23 * j * radius, 0.0};
                    const Ray<double> ray{aim - 30.0 * direction, direction};
                    const optics::TracedRay<double> a = optics::trace(one, ray);
                    const optics::TracedRay<double> b = optics::trace(other, ray);
                    ASSERT_EQ(a.status, b.status) << field << " " << i << " " << j;
                    if (a.status == optics::RayStatus::ok) {
                        ++passed;
                        const Vec3d difference = optics::meet_plane(a.ray, one.image_z).point -
                                                 optics::meet_plane(b.ray, other.image_z).point;
                        EXPECT_NEAR(length(difference), 0.0, 1e-9) << field << " " << i << " " << j;
                    }
                }
            }
        }
    }
    EXPECT_GT(passed, 300);
}

}  // namespace lensproof::formats
