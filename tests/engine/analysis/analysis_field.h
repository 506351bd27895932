// tests/engine/analysis/analysis_field.h — fields of lenses for the tests of focus, PSF and MTF.
#pragma once
#include <vector>

#include "engine/analysis/polychromatic_field.h"
#include "engine/formats/prescription/load_lens.h"
#include "engine/optics/focus.h"
#include "engine/spectral/wavelengths.h"

namespace lensproof::analysis {

inline PolychromaticField field_of(const optics::Lens& lens, double field_angle,
                                   const std::vector<WeightedWavelength>& wavelengths = {{spectral::kLineD, 1.0}}) {
    const optics::ChiefRays chief_rays(lens, spectral::kLineD, optics::Rims::follow);
    return polychromatic_field(lens, optics::field_bundle(chief_rays, field_angle).value(), spectral::kLineD,
                               wavelengths);
}

/// A lens that ships.
struct Case {
    const char* lens;
    double f_number;  // 0: as wide as it opens
    double field_deg;
};

inline optics::Lens lens_of(const Case& c) {
    const optics::Lens lens = formats::load_lens(c.lens);
    return c.f_number > 0.0 ? optics::with_f_number(lens, c.f_number) : lens;
}

}  // namespace lensproof::analysis
