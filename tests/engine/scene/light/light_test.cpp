#include "engine/scene/light/light.h"

#include <gtest/gtest.h>

#include "engine/scene/geometry/geometry.h"

namespace lensproof::scene::light_test {

const spectral::SpectralGrid kGrid = spectral::spectral_grid(500.0, 600.0, 4);

SunLight sun(const Vec3d& towards, double radiance) {
    return {.towards = towards, .cos_radius = 0.9999, .radiance = spectral::constant_spectrum(radiance, kGrid)};
}

// Two suns, the one three times as bright, beside an even sky: each path that starts at a sun carries the sum of both,
// and three of four are the brighter one's; those of all lights name suns as what they are.
TEST(Lights, StartAtSunsByTheirPower) {
    const std::vector<Shape> shapes{Sphere{1.0}};
    const std::vector<SceneObject> objects{{.shape = 0, .to_world = {.linear = kIdentity3, .translation = {}}}};
    const SceneGeometry geometry(shapes, objects);
    const Lights lights(geometry, {ConstantLight{spectral::constant_spectrum(1.0, kGrid)}, sun({0.0, 0.0, 1.0}, 300.0),
                                   sun({0.0, 1.0, 0.0}, 100.0)});
    ASSERT_EQ(lights.suns().size(), 2U);
    const double both = lights.suns()[0].irradiance() + lights.suns()[1].irradiance();
    const spectral::PathWavelengths path = kGrid.path(0);
    constexpr int kStarts = 1000;
    int bright = 0;
    for (int i = 0; i < kStarts; ++i) {
        const LightStart start = lights.start_at_sun(path, (i + 0.5) / kStarts, 0.3, 0.6);
        EXPECT_TRUE(start.is_sun);
        EXPECT_NEAR(start.value[0] / both, 1.0, 1e-6);
        bright += dot(start.direction, {0.0, 0.0, -1.0}) > 0.9 ? 1 : 0;
        const LightStart any = lights.start(path, (i + 0.5) / kStarts, 0.3, 0.6);
        EXPECT_EQ(any.is_sun, any.light > 0);
    }
    EXPECT_EQ(bright, 750);
}

}  // namespace lensproof::scene::light_test
