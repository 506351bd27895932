// Beams that the stop's blades shape, and what a lens turned about its axis leaves as it was.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/analysis/beam_outline.h"
#include "engine/base/angle.h"
#include "engine/optics/illumination.h"
#include "engine/spectral/wavelengths.h"

namespace lensproof::analysis::rim_test {

/// A bare stop of radius 2 mm, 40 mm in front of the sensor.
optics::Prescription bare_stop(optics::StopShape shape) {
    optics::Prescription prescription;
    prescription.surfaces = {{.thickness_mm = 40.0, .semi_diameter_mm = 2.0, .is_stop = true}};
    prescription.stop_shape = std::move(shape);
    return prescription;
}

// Seven straight blades leave 7/2 sin(2π/7) r², whatever the angle at which the beam falls on them takes from that; the
// outline's corners are found, so the area is good to 1e-11.
TEST(BeamOutline, BladesAreFollowedWithTheirCorners) {
    const optics::Lens lens =
        optics::make_lens(bare_stop(optics::PolygonStop{.blades = 7, .rotation_deg = 11.0}), optics::GlassCatalogue{});
    const optics::TraceLens<double> traced = optics::at_wavelength<double>(lens, spectral::kLineD);
    const optics::ChiefRays rays(lens, spectral::kLineD);
    for (const double field : {0.0, 0.4}) {
        const optics::RegionOutline outline = beam_outline(traced, {.chief = rays.at_field(field).value()});
        const double expected = 3.5 * std::sin(2.0 * kPi / 7.0) * 4.0 * std::cos(field);
        EXPECT_NEAR(outline.area / expected, 1.0, 1e-11) << field;
        EXPECT_FALSE(outline.is_half);
    }
}

// From a micrometre's pinhole to a stop that does not limit anything, on the axis and off it: the bare stop's disc seen
// obliquely. A closed stop leaves nothing, and says so.
TEST(BeamOutline, StopsOfEverySize) {
    for (const double radius : {1e-3, 0.05, 2.0, 500.0}) {
        const optics::Lens lens = optics::make_lens(
            [&] {
                optics::Prescription prescription = bare_stop({});
                prescription.surfaces[0].semi_diameter_mm = radius;
                return prescription;
            }(),
            optics::GlassCatalogue{});
        const optics::TraceLens<double> traced = optics::at_wavelength<double>(lens, spectral::kLineD);
        const optics::ChiefRays rays(lens, spectral::kLineD);
        for (const double field : {0.0, 1.0}) {
            const double expected = kPi * radius * radius * std::cos(field);
            const optics::RegionOutline outline = beam_outline(traced, {.chief = rays.at_field(field).value()});
            EXPECT_NEAR(outline.area / expected, 1.0, 1e-11) << radius;
        }
    }
    optics::Lens closed = optics::make_lens(bare_stop({}), optics::GlassCatalogue{});
    closed.surfaces[0].semi_diameter = 0.0;
    const optics::TraceLens<double> traced = optics::at_wavelength<double>(closed, spectral::kLineD);
    EXPECT_TRUE(
        beam_outline(traced, {.chief = optics::ChiefRays(closed, spectral::kLineD).at_field(0.0).value()}).is_empty());
    EXPECT_TRUE(optics::image_outline(traced, {}).is_empty());
}

}  // namespace lensproof::analysis::rim_test
