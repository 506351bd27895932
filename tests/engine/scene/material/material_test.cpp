#include "engine/scene/material/material.h"

#include <gtest/gtest.h>

#include "engine/base/input_error.h"
#include "engine/spectral/metal.h"
#include "tests/engine/scene/bsdf/bsdf_cases.h"

namespace lensproof::scene::material_test {
namespace {

spectral::SpectralGrid grid() {
    return spectral::spectral_grid(400.0, 700.0, 16);
}

Material diffuse(double albedo) {
    return {.surface = DiffuseMaterial{.albedo = spectral::constant_spectrum(albedo, grid())}, .radiance = {}};
}

const Vec2d kMiddle{0.5, 0.5};

// A surface has its materials' numbers at the path's wavelengths.
TEST(Material, ScattersAsItsTablesSayThere) {
    const spectral::PathWavelengths path = grid().path(3);
    const spectral::ComplexIndex gold = spectral::metal("gold");
    const Material mirror{
        .surface = conductor_material(spectral::at_midpoints(gold.n, grid()), spectral::at_midpoints(gold.k, grid()),
                                      {.alpha_x = 0.1, .alpha_y = 0.2}),
        .radiance = {}};
    const auto metal_there = std::get<ConductorBsdf>(bsdf_at(mirror, kMiddle, path));
    for (std::size_t c = 0; c < spectral::kWavelengthsPerPath; ++c) {
        EXPECT_EQ(metal_there.n[c], static_cast<float>(gold.n(grid().wavelengths_nm(path)[c])));
        EXPECT_EQ(metal_there.k[c], static_cast<float>(gold.k(grid().wavelengths_nm(path)[c])));
    }
    EXPECT_EQ(metal_there.roughness.alpha_y, 0.2);
    ASSERT_NE(metal_there.losses, nullptr);
    // What reflects R at a facet reflects R² and less after two: between the reflectance head on and its square.
    const float head_on = normal_albedo(metal_there)[0];
    EXPECT_LT(metal_there.given_back[0], head_on);
    EXPECT_GT(metal_there.given_back[0], 0.5F * head_on * head_on);
    const auto cauchy = [](double nm) { return 1.5 + 5000.0 / (nm * nm); };
    const Material glass{.surface = dielectric_material(spectral::tabulated(grid(), cauchy), {}), .radiance = {}};
    const auto glass_there = std::get<DielectricBsdf>(bsdf_at(glass, kMiddle, path));
    EXPECT_EQ(glass_there.eta[1], static_cast<float>(cauchy(grid().wavelengths_nm(path)[1])));
    const Material plastic{.surface = plastic_material(spectral::constant_spectrum(1.0, grid()), 1.5, 0.0),
                           .radiance = {}};
    EXPECT_EQ(std::get<PlasticBsdf>(bsdf_at(plastic, kMiddle, path)).base, spectral::SpectralSample(1.0F));
}

// Lamps say what they send out; all else sends nothing.
TEST(Material, EmitsWhatItIsGiven) {
    Material lamp = diffuse(0.0);
    EXPECT_TRUE(spectral::is_black(radiance_at(lamp, kMiddle, grid().path(0))));
    lamp.radiance = spectral::constant_spectrum(3.0, grid());
    EXPECT_EQ(radiance_at(lamp, kMiddle, grid().path(0)), spectral::SpectralSample(3.0F));
}

// Of mixes of mixes each material has its share of its share, and all of them make one: Lambertian surfaces of albedo
// 0, 0.2, 0.5, 1 mixed by 0.25, 0.6 and 0.5 look like one of the mean albedo, here by hand.
TEST(Material, MixesShareTheSurface) {
    const Material dark{.surface = mixed(diffuse(0.0), diffuse(0.2), 0.25), .radiance = {}};
    const Material bright{.surface = mixed(diffuse(0.5), diffuse(1.0), 0.6), .radiance = {}};
    const Material all{.surface = mixed(dark, bright, 0.5), .radiance = {}};
    const Bsdf there = bsdf_at(all, kMiddle, grid().path(0));
    double sum = 0.0;
    const auto& mix = std::get<MixBsdf>(there);
    ASSERT_EQ(mix.count, 4U);
    for (std::size_t i = 0; i < mix.count; ++i) {
        sum += mix.fraction[i];
    }
    EXPECT_NEAR(sum, 1.0, 1e-15);
    const double mean = 0.5 * (0.25 * 0.2) + 0.5 * (0.4 * 0.5 + 0.6 * 1.0);
    EXPECT_NEAR(normal_albedo(there)[0], mean, 0x1p-22);
    const Vec3d up{0.0, 0.0, 1.0};
    EXPECT_NEAR(evaluate(there, up, up, Transport::radiance)[0], mean / std::numbers::pi, 0x1p-22);
    EXPECT_THROW(mixed(all, diffuse(0.3), 0.5), InputError) << "five materials";
}

// Where a mask says none of a material, nothing of it is drawn; where it says half, half.
TEST(Material, MasksChooseByPlace) {
    const ScalarImage mask{.grid = {.width = 2, .height = 1, .wrap_u = Wrap::clamp, .wrap_v = Wrap::clamp},
                           .texel = {0.0F, 1.0F}};
    const Material mix{.surface = mixed(diffuse(0.2), diffuse(0.8), mask), .radiance = {}};
    const auto albedo = [&](double u) { return normal_albedo(bsdf_at(mix, {u, 0.5}, grid().path(0)))[0]; };
    EXPECT_EQ(albedo(0.1), 0.2F);
    EXPECT_NEAR(albedo(0.5), 0.5, 0x1p-22);
    EXPECT_EQ(albedo(0.9), 0.8F);
    EXPECT_EQ(std::get<MixBsdf>(bsdf_at(mix, {0.1, 0.5}, grid().path(0))).count, 1U);
    for (const double u_lobe : {1e-9, 0.5, 1.0 - 1e-9}) {
        const auto drawn =
            sample(bsdf_at(mix, {0.9, 0.5}, grid().path(0)), {0.0, 0.0, 1.0}, u_lobe, 0.3, 0.6, Transport::radiance);
        ASSERT_TRUE(drawn);
        EXPECT_NEAR(drawn->weight[0], 0.8, 0x1p-22);
    }
}

}  // namespace
}  // namespace lensproof::scene::material_test
