#include "engine/scene/material/material.h"

#include <gtest/gtest.h>

#include "engine/base/input_error.h"
#include "engine/spectral/metal.h"
#include "tests/engine/scene/bsdf/bsdf_cases.h"

namespace lensproof::scene::material_test {

spectral::SpectralGrid grid() {
    return spectral::spectral_grid(400.0, 700.0, 16);
}

Material diffuse(double albedo) {
    return {DiffuseMaterial{.albedo = spectral::constant_spectrum(albedo, grid())}};
}

const Vec2d kMiddle{0.5, 0.5};

// A surface has its materials' numbers at the path's wavelengths.
TEST(Material, ScattersAsItsTablesSayThere) {
    const spectral::PathWavelengths path = grid().path(3);
    const spectral::ComplexIndex gold = spectral::metal("gold");
    const Material mirror{conductor_material(spectral::at_midpoints(gold.n, grid()),
                                             spectral::at_midpoints(gold.k, grid()), {.alpha_x = 0.1, .alpha_y = 0.2})};
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
    const Material glass{dielectric_material(spectral::tabulated(grid(), cauchy), {})};
    const auto glass_there = std::get<DielectricBsdf>(bsdf_at(glass, kMiddle, path));
    EXPECT_EQ(glass_there.eta[1], static_cast<float>(cauchy(grid().wavelengths_nm(path)[1])));
    const Material plastic{plastic_material(spectral::constant_spectrum(1.0, grid()), 1.5, 0.0)};
    EXPECT_EQ(std::get<PlasticBsdf>(bsdf_at(plastic, kMiddle, path)).base, spectral::SpectralSample(1.0F));
}

// Only what varies over the surface asks where on it.
TEST(Material, ReadsUvWhereItsTextureVaries) {
    const Material picture{DiffuseMaterial{.albedo = ImageTexture{}}};
    EXPECT_TRUE(reads_uv(picture));
    EXPECT_TRUE(reads_uv({plastic_material(ImageTexture{}, 1.5, 0.0)}));
    EXPECT_TRUE(reads_uv({mixed(diffuse(0.5), picture, 0.5)}));
    EXPECT_FALSE(reads_uv(diffuse(0.5)));
    EXPECT_FALSE(reads_uv({plastic_material(spectral::constant_spectrum(1.0, grid()), 1.5, 0.0)}));
    EXPECT_FALSE(reads_uv({mixed(diffuse(0.5), diffuse(0.2), 0.5)}));
    EXPECT_FALSE(reads_uv({dielectric_material(spectral::constant_spectrum(1.5, grid()), {})}));
}

// Of mixes of mixes each material has its fraction of its fraction, and all of them make one: Lambertian surfaces of
// albedo 0, 0.2, 0.5, 1 mixed by 0.25, 0.6 and 0.5 look like one of the mean albedo, here by hand.
TEST(Material, MixesShareTheSurface) {
    const Material dark{mixed(diffuse(0.0), diffuse(0.2), 0.25)};
    const Material bright{mixed(diffuse(0.5), diffuse(1.0), 0.6)};
    const Material all{mixed(dark, bright, 0.5)};
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

// Of a material that has no part in a mix nothing is drawn.
TEST(Material, OfNoFractionIsLeftOut) {
    for (const double fraction : {0.0, 0.5, 1.0}) {
        const Material mix{mixed(diffuse(0.2), diffuse(0.8), fraction)};
        const Bsdf there = bsdf_at(mix, kMiddle, grid().path(0));
        EXPECT_NEAR(normal_albedo(there)[0], 0.2 + 0.6 * fraction, 0x1p-22);
        EXPECT_EQ(std::get<MixBsdf>(there).count, fraction == 0.5 ? 2U : 1U);
        for (const double u_lobe : {1e-9, 0.5, 1.0 - 1e-9}) {
            const auto drawn = sample(there, {0.0, 0.0, 1.0}, bsdf_numbers(u_lobe, 0.3, 0.6), Transport::radiance);
            ASSERT_TRUE(drawn);
            EXPECT_NEAR(drawn->weight[0], 0.2 + 0.6 * fraction, 0x1p-22);
        }
    }
}

}  // namespace lensproof::scene::material_test
