// tests/engine/analysis/analysis_field.h — fields of lenses for the tests of focus, PSF and MTF.
#pragma once
#include <string>
#include <vector>

#include "engine/analysis/polychromatic_field.h"
#include "engine/base/infinity.h"
#include "engine/formats/prescription/load_lens.h"
#include "engine/optics/focus.h"
#include "engine/optics/paraxial.h"
#include "engine/spectral/wavelengths.h"

namespace lensproof::analysis {

inline PolychromaticField field_of(const optics::Lens& lens, double field_angle,
                                   const std::vector<WeightedWavelength>& wavelengths = {{spectral::kLineD, 1.0}}) {
    const optics::ChiefRays chief_rays(lens, spectral::kLineD, optics::Rims::follow);
    return polychromatic_field(lens, optics::field_bundle(chief_rays, field_angle).value(), spectral::kLineD,
                               wavelengths);
}

/// A lens that ships, or one of those below.
struct Case {
    const char* lens;
    double f_number;  // 0: as wide as it opens
    double field_deg;
};

/// Of f = 500 mm at f/5, its own stop; the sensor stands in front of it.
inline constexpr const char* kMirror = "a paraboloidal mirror";
/// The Tessar, 60 mm before a block of glass in which its sensor stands, in the paraxial focus.
inline constexpr const char* kSensorInGlass = "a Tessar before glass";

inline optics::Lens lens_named(const std::string& name) {
    if (name == kMirror) {
        optics::Prescription prescription{.name = name, .surfaces = {}};
        prescription.surfaces = {{.radius_mm = -1000.0,
                                  .conic = -1.0,
                                  .thickness_mm = -500.0,
                                  .semi_diameter_mm = 50.0,
                                  .medium = {},
                                  .is_mirror = true,
                                  .is_stop = true}};
        return optics::make_lens(prescription, {});
    }
    if (name == kSensorInGlass) {
        optics::Lens lens = formats::load_lens("tessar");
        lens.surfaces.push_back({.vertex_z = lens.last_vertex_z() + 60.0,
                                 .semi_diameter = 40.0,
                                 .medium = optics::constant_glass("glass", 1.5)});
        const auto traced = optics::at_wavelength<double>(lens, spectral::kLineD);
        lens.image_z = lens.last_vertex_z() + optics::paraxial_image_distance(traced, kInfinity);
        return lens;
    }
    return formats::load_lens(name);
}

inline optics::Lens lens_of(const Case& c) {
    const optics::Lens lens = lens_named(c.lens);
    return c.f_number > 0.0 ? optics::with_f_number(lens, c.f_number) : lens;
}

}  // namespace lensproof::analysis
