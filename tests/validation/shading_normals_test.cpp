// Smooth normals on coarse meshes: no black rims, no light out of nothing, and one image from either end.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "engine/render/integrators/path_tracer.h"
#include "tests/engine/scene/scene_shapes.h"
#include "tests/validation/studio.h"

namespace lensproof::shading_normals_test {

const spectral::SpectralGrid kGrid = spectral::spectral_grid(420.0, 680.0, 16);

/// An icosahedron's triangles, cut into four `levels` times, with a sphere's normals.
scene::TriangleMesh coarse_ball(double radius_mm, int levels) {
    scene::TriangleMesh mesh = scene::test::icosphere(radius_mm, levels);
    for (const Vec3<float>& position : mesh.positions) {
        mesh.normals.push_back(scene::converted<float>(normalized(scene::converted<double>(position))));
    }
    return mesh;
}

/// Reflects all but 2 / (k² cos i): less than a thousandth up to 0.01° from grazing.
scene::Material mirror() {
    return {scene::ConductorMaterial{.n = spectral::constant_spectrum(1.0, kGrid),
                                     .k = spectral::constant_spectrum(4000.0, kGrid),
                                     .roughness = {}}};
}

SceneParts in_an_even_sky(int levels, const scene::Material& material) {
    SceneParts parts(kGrid);
    // Turned so that triangles are seen at all angles.
    parts.add(coarse_ball(100.0, levels), {.linear = product(about_x(17.0), about_y(29.0))}, material);
    parts.lights.emplace_back(scene::ConstantLight{spectral::constant_spectrum(1.0, kGrid)});
    return parts;
}

/// What is seen of the ball along parallel rays.
struct Seen {
    int rays = 0;
    int at_the_rim = 0;  // where the normal looks away from the camera, or mirrors it into the ball
    int away = 0;        // of these the former
    double least = 1e9;
    double most = 0.0;
    double rim_mean = 0.0;
};
Seen seen_of(const SceneParts& parts, int paths) {
    const scene::Scene scene = parts.scene();
    Seen seen;
    constexpr int kSide = 61;
    for (int i = 0; i < kSide * kSide; ++i) {
        const int column = i % kSide;
        const int row = i / kSide;
        const Ray<double> ray{{210.0 * (column + 0.5) / kSide - 105.0, 210.0 * (row + 0.5) / kSide - 105.0, 500.0},
                              {0.0, 0.0, -1.0}};
        const auto hit = scene::intersect(*scene.geometry, ray.origin, ray.direction, 0.0, 1e9);
        if (!hit) {
            continue;
        }
        double sum = 0.0;
        for (int path = 0; path < paths; ++path) {
            render::PathSampler numbers(5, static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(path));
            sum += spectral::mean(
                render::trace_path(scene, ray, kGrid.path(path % kGrid.size()), {.max_bounces = 4}, numbers).radiance);
        }
        const double value = sum / paths;
        ++seen.rays;
        seen.least = std::min(seen.least, value);
        seen.most = std::max(seen.most, value);
        if (render::bent_normal(*hit, -1.0 * ray.direction)) {
            ++seen.at_the_rim;
            seen.away += dot(hit->shading_normal, ray.direction) >= 0.0 ? 1 : 0;
            seen.rim_mean += value;
        }
    }
    seen.rim_mean /= std::max(1, seen.at_the_rim);
    return seen;
}

// A mirror ball in an even sky of radiance 1 cannot be seen; every ray that meets the coarse one goes on above its
// triangle, and so leaves it.
TEST(ShadingNormals, AMirrorInAnEvenSkyHasNoRim) {
    for (const int levels : {0, 1, 2}) {
        const Seen seen = seen_of(in_an_even_sky(levels, mirror()), 1);
        EXPECT_GT(seen.at_the_rim, 10) << levels;
        EXPECT_NEAR(seen.least, 1.0, 1e-3) << levels;
        EXPECT_LE(seen.most, 1.0) << levels;
    }
}

// A matt ball of albedo 0.8 has the radiance 0.8. Of a normal that stands at θ to its triangle's, (1 − cos θ) / 2 of
// the light that it would gather comes from below the triangle; the icosahedron's normals lie within 37.4° of its
// triangles' (their own at their corners: the in-radius of 0.7947 R), the bent ones do not lie farther. No more is
// lost, and none is gained.
TEST(ShadingNormals, AMattBallLosesNoMoreThanItsTerminator) {
    const scene::Material matt{scene::DiffuseMaterial{spectral::constant_spectrum(0.8, kGrid)}};
    const Seen seen = seen_of(in_an_even_sky(0, matt), 256);
    EXPECT_GT(seen.at_the_rim, 10);
    EXPECT_GT(seen.away, 0);
    EXPECT_LE(seen.rim_mean, 0.8 * (1.0 + 2e-3));
    EXPECT_GE(seen.rim_mean, 0.8 * 0.5 * (1.0 + 0.7947) - 2e-3);
    EXPECT_GT(seen.least, 0.5);
}

TEST(ShadingNormals, BendOnlyWhereTheyMust) {
    scene::SurfaceHit hit;
    hit.geometric_normal = {0, 0, 1};
    hit.tangent = {0, 1, 0};
    const double tilt = 0.3;
    hit.shading_normal = {std::sin(tilt), 0.0, std::cos(tilt)};
    for (int i = -89; i <= 89; ++i) {
        const double angle = i * std::numbers::pi / 180.0;
        for (const double side : {1.0, -1.0}) {
            const Vec3d towards{std::sin(angle) * side, 0.0, std::cos(angle) * side};
            const auto bent = render::bent_normal(hit, towards);
            // The image of `angle` lies at 2 · tilt − angle.
            EXPECT_EQ(bent.has_value(), 2.0 * tilt - angle >= 0.5 * std::numbers::pi) << i;
            if (bent) {
                EXPECT_GT(side * dot(*bent, towards), 0.0);
                const Vec3d image = 2.0 * dot(*bent, towards) * *bent - towards;
                EXPECT_NEAR(side * image.z, std::min(0.9 * side * towards.z, 0.01), 1e-12);
                EXPECT_NEAR(length(*bent), 1.0, 1e-12);
            }
        }
    }
}

// What camera paths see of a coarse ball, light paths bring: glossy and matt, where no mirror or smooth glass sends
// them; with a mirror, both together.
TEST(ShadingNormals, AreOneImageFromEitherEnd) {
    const auto scene_with = [](const scene::Material& material) {
        SceneParts parts(kGrid);
        parts.add(scene::Quad{4000.0, 4000.0}, {.linear = about_x(180.0), .translation = {0.0, 0.0, 2600.0}}, 0.7);
        parts.add(coarse_ball(450.0, 0), {.linear = kIdentity3, .translation = {0.0, 0.0, 2000.0}}, material);
        const std::uint32_t lamp =
            parts.add(scene::Sphere{100.0}, {.linear = kIdentity3, .translation = {-700.0, 300.0, 1800.0}}, 0.0);
        parts.lights.emplace_back(
            scene::AreaLight{.object = lamp, .radiance = spectral::constant_spectrum(30.0, kGrid)});
        parts.lights.emplace_back(scene::ConstantLight{spectral::constant_spectrum(0.5, kGrid)});
        return parts;
    };
    const Studio::Setup setup{.lens = "double-gauss-tronnier",
                              .f_number = 8.0,
                              .model = render::LensModel::thin_lens,
                              .sensor = {.width = 9, .height = 6, .pixel_pitch_mm = 4.0},
                              .grid = kGrid,
                              .max_bounces = 3};
    const scene::Material matt{scene::DiffuseMaterial{spectral::constant_spectrum(0.8, kGrid)}};
    const scene::Material glossy{scene::plastic_material(spectral::constant_spectrum(0.3, kGrid), 1.5, 0.2)};
    for (const scene::Material& material : {matt, glossy}) {
        const SceneParts parts = scene_with(material);
        const Studio studio(setup, parts);
        const render::Film camera = studio.by_camera(2048);
        expect_same_image(studio.by_both(1024), camera);
        expect_same_image(studio.by_lights(8192), camera);
    }
    const SceneParts parts = scene_with(mirror());
    const Studio studio(setup, parts);
    expect_same_image(studio.by_both(1024), studio.by_camera(4096));
}

}  // namespace lensproof::shading_normals_test
