// What glass takes of the light on its way through it, by the internal transmittance that catalogues state.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/formats/prescription/load_lens.h"
#include "engine/optics/packet/trace_batch.h"
#include "engine/optics/trace.h"

namespace lensproof::optics::absorption_test {

/// A plate of 8 mm, index 1.5, behind it a stop; its glass has these data, through 10 mm.
Lens plate(const std::vector<TransmittancePoint>& data) {
    const auto row = [](double thickness_mm, std::optional<double> n_d) {
        PrescribedSurface surface{.thickness_mm = thickness_mm, .semi_diameter_mm = 50.0};
        surface.medium.n_d = n_d;
        return surface;
    };
    Prescription prescription;
    prescription.surfaces = {row(8.0, 1.5), row(1.0, {}), row(5.0, {})};
    prescription.surfaces[2].is_stop = true;
    Lens lens = make_lens(prescription, GlassCatalogue{});
    lens.surfaces[0].medium.internal_transmittance = data;
    return lens;
}

// The exponential law over the slanted path, both ways, beside Fresnel's losses. A ray beyond the table's wavelengths
// loses nothing to the glass. Four products and a root: 8 ulp.
TEST(Absorption, FollowsThePathThroughThePlate) {
    const Lens lens = plate({{400.0, 0.9, 10.0}, {700.0, 0.98, 10.0}});
    for (const double angle : {0.0, 0.5, 1.2}) {
        const Ray<double> ray{{0.0, 0.0, -1.0}, {0.0, std::sin(angle), std::cos(angle)}};
        const double cosine = std::sqrt(1.0 - std::pow(std::sin(angle) / 1.5, 2));
        const double surfaces = std::pow(fresnel_transmittance(1.0 / 1.5, std::cos(angle), cosine).value(), 2);
        const double glass = std::pow(0.94, 8.0 / cosine / 10.0);
        const TracedRay<double> there = trace(at_wavelength<double>(lens, 550.0), ray);
        EXPECT_NEAR(there.transmittance, surfaces * glass, 2e-15) << angle;
        const Ray<double> back{there.ray.origin, -1.0 * there.ray.direction};
        EXPECT_NEAR(trace<Direction::reverse>(at_wavelength<double>(lens, 550.0), back).transmittance, surfaces * glass,
                    2e-15);
        EXPECT_NEAR(trace(at_wavelength<double>(lens, 750.0), ray).transmittance, surfaces, 2e-15);
    }
}

// A table that says 0 is as dark as a number may be, and no ray's numbers suffer.
TEST(Absorption, OpaqueGlassPassesNothing) {
    const Lens lens = plate({{400.0, 0.0, 10.0}, {700.0, 0.0, 10.0}});
    const TracedRay<double> traced = trace(at_wavelength<double>(lens, 550.0), Ray<double>{{0, 0, -1}, {0, 0, 1}});
    EXPECT_EQ(traced.status, RayStatus::ok);
    EXPECT_GE(traced.transmittance, 0.0);
    EXPECT_LT(traced.transmittance, 1e-300);
}

// The Tessar's glasses, from the catalogues that ship: what their tables leave over each ray's paths, surface by
// surface, and what the same lens passes without these data.
TEST(Absorption, IsWhatTheCataloguesState) {
    const Lens lens = formats::load_lens("tessar");
    Lens clear = lens;
    for (LensSurface& surface : clear.surfaces) {
        surface.medium.internal_transmittance.clear();
    }
    for (const double nm : {400.0, 550.0, 650.0}) {
        const TraceLens<double> at = at_wavelength<double>(lens, nm);
        const TraceLens<double> at_clear = at_wavelength<double>(clear, nm);
        EXPECT_FALSE(at.attenuation.empty());
        EXPECT_TRUE(at_clear.attenuation.empty());
        const Ray<double> ray{{3.0, 5.0, -10.0}, normalized(Vec3d{-0.02, 0.1, 1.0})};
        Vec3d before = ray.origin;
        double left = 1.0;
        const TracedRay<double> traced = trace(at, ray, [&](const SurfaceEvent<double>& event) {
            if (event.surface > 0) {
                const Glass& medium = lens.surfaces[static_cast<std::size_t>(event.surface) - 1].medium;
                left *= internal_transmittance(medium, nm, length(event.ray.origin - before)).value_or(1.0);
            }
            before = event.ray.origin;
        });
        const TracedRay<double> without = trace(at_clear, ray);
        ASSERT_EQ(traced.status, RayStatus::ok);
        EXPECT_LT(left, 1.0);
        EXPECT_NEAR(traced.transmittance / without.transmittance, left, 1e-14);
        EXPECT_EQ(traced.ray.direction, without.ray.direction);  // bit by bit
        EXPECT_EQ(traced.optical_path, without.optical_path);
    }
}

// A lens of which figures alone are known absorbs nothing, and is traced as before.
TEST(Absorption, NeedsData) {
    EXPECT_TRUE(at_wavelength<double>(formats::load_lens("biotar"), 450.0).attenuation.empty());
}

}  // namespace lensproof::optics::absorption_test
