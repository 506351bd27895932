#include "engine/scene/material/metallic_material.h"

#include <gtest/gtest.h>

#include "engine/scene/bsdf/fresnel.h"
#include "engine/scene/material/material.h"
#include "tests/engine/scene/bsdf/bsdf_cases.h"
#include "tests/validation/measured.h"

namespace lensproof::scene::metallic_material_test {

spectral::SpectralGrid grid() {
    return spectral::spectral_grid(400.0, 700.0, 16);
}

/// Roughness from 0.1 to 1 along u, between 512 pixels.
std::shared_ptr<const NumberTexture> ramp() {
    NumberTexture numbers{.grid = {.width = 512, .height = 1, .wrap_u = Wrap::clamp, .wrap_v = Wrap::clamp},
                          .value = {}};
    for (int i = 0; i < 512; ++i) {
        numbers.value.push_back(0.1F + 0.9F * (static_cast<float>(i) + 0.5F) / 512.0F);
    }
    return std::make_shared<const NumberTexture>(std::move(numbers));
}

MetallicMaterial made(double base, double metallic, double transmission, VaryingNumber roughness, bool is_body) {
    MetallicMaterial material{.base_colour = spectral::constant_spectrum(base, grid()),
                              .metallic = {.factor = metallic},
                              .roughness = std::move(roughness),
                              .transmission = {.factor = transmission},
                              .is_body = is_body,
                              .facets = {},
                              .metal_means = {}};
    prepare(material);
    return material;
}

Measured returned_light(const MixBsdf& bsdf, const Vec3d& wo, Uniform& uniform) {
    std::vector<double> weights(8000);
    std::ranges::generate(weights, [&] {
        const auto drawn = sample(bsdf, wo, bsdf_numbers(uniform(), uniform(), uniform()), Transport::importance);
        return drawn ? drawn->weight[1] : 0.0;
    });
    return lensproof::mean_of(weights);
}

// In a white furnace what is white returns all light, of whatever it is made: metal and plastic of even roughness to
// their tables' 2e-3 (1e-3 of plastic), and 1e-4 that no metal reflects; of varying roughness, whose tables are those
// of the nearest step, within 1 % (the losses of mirrors grow by less than 1 for α, and a step is 1/64).
TEST(MetallicMaterial, WhiteReturnsAllLight) {
    Uniform uniform(3);
    for (const auto& [metallic, transmission, is_body] :
         {std::tuple(1.0, 0.0, false), {0.0, 0.0, false}, {0.0, 1.0, false}, {0.0, 1.0, true}, {0.3, 0.4, true}}) {
        for (const double mu : {0.95, 0.4}) {
            for (const double roughness : {0.0, 0.3, 0.7, 1.0}) {
                const MetallicMaterial even =
                    made(1.0, metallic, transmission, {.factor = roughness, .picture = {}}, is_body);
                const Measured returned =
                    returned_light(at_point(even, {0.5, 0.5}, grid().path(0)), direction(mu, 0.3), uniform);
                EXPECT_NEAR(returned.value, 1.0, 5.0 * returned.error + 2.2e-3)
                    << metallic << " " << transmission << " " << roughness;
            }
            const MetallicMaterial varying =
                made(1.0, metallic, transmission, {.factor = 1.0, .picture = ramp()}, is_body);
            for (const double u : {0.02, 0.31, 0.62, 0.93, 0.98}) {
                const Measured returned =
                    returned_light(at_point(varying, {u, 0.5}, grid().path(0)), direction(mu, 0.3), uniform);
                EXPECT_NEAR(returned.value, 1.0, 5.0 * returned.error + 1e-2)
                    << metallic << " " << transmission << " " << u;
            }
        }
    }
}

// f(wo, wi) = f(wi, wo) of what reflects, and for what passes of radiance and importance; to float's rounding of
// either.
TEST(MetallicMaterial, IsReciprocal) {
    Uniform uniform(4);
    const MetallicMaterial all = made(0.6, 0.3, 0.4, {.factor = 1.0, .picture = ramp()}, true);
    for (int i = 0; i < 200; ++i) {
        const MixBsdf bsdf = at_point(all, {uniform(), 0.5}, grid().path(0));
        const Vec3d wo = random_direction(uniform);
        const Vec3d wi = random_direction(uniform);
        const double there = evaluate(bsdf, wo, wi, Transport::radiance)[0] / std::abs(wi.z);
        const double back = evaluate(bsdf, wi, wo, Transport::importance)[0] / std::abs(wo.z);
        EXPECT_NEAR(there, back, 1e-5 * back + 1e-12);
    }
}

// Head on metal reflects its base colour, glass 4 % of all and the rest tinted: a body by √ρ at each of its surfaces, a
// pane by ρ at once, after reflections between its faces: R + (1 − R)² R / (1 − R²), the geometric series.
TEST(MetallicMaterial, HasItsBaseColour) {
    constexpr float kRho = 0.64F;
    const VaryingNumber smooth{.factor = 0.0, .picture = {}};
    const auto albedo = [&](double metallic, double transmission, bool is_body) {
        return normal_albedo(at_point(made(kRho, metallic, transmission, smooth, is_body), {}, grid().path(0)))[2];
    };
    EXPECT_NEAR(albedo(1.0, 0.0, false), kRho, 1e-6);
    EXPECT_NEAR(albedo(0.0, 1.0, true), 0.04 + 0.96 * 0.8, 1e-6);
    const double pane = 0.04 + 0.96 * 0.96 * 0.04 / (1.0 - 0.04 * 0.04);
    EXPECT_NEAR(albedo(0.0, 1.0, false), pane + (1.0 - pane) * kRho, 1e-6);
    const MixBsdf bsdf = at_point(made(kRho, 0.0, 1.0, smooth, false), {}, grid().path(0));
    const Vec3d wo = direction(0.5, 1.0);
    const auto through = sample(bsdf, wo, bsdf_numbers(0.9, 0.5, 0.5), Transport::radiance);
    ASSERT_TRUE(through);
    EXPECT_EQ(through->wi, -1.0 * wo) << "a pane bends nothing";
    EXPECT_NEAR(through->weight[0], kRho, 1e-6);
}

// Numbers that vary are a factor of their picture's.
TEST(MetallicMaterial, VariesAsItsPictures) {
    const MetallicMaterial varying = made(0.5, 1.0, 0.0, {.factor = 0.5, .picture = ramp()}, false);
    const MixBsdf there = at_point(varying, {0.5, 0.5}, grid().path(0));
    ASSERT_EQ(there.count, 1U);
    const auto& metal = std::get<ConductorBsdf>(there.part[0]);
    EXPECT_NEAR(metal.roughness.alpha_x, std::pow(0.5 * 0.55, 2), 1e-6);
    EXPECT_NE(metal.losses, nullptr);
}

}  // namespace lensproof::scene::metallic_material_test
