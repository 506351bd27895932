#include "tests/fuzz/use_what_was_read.h"

#include "engine/check/checker.h"
#include "engine/optics/lens.h"

namespace lensproof {

void use(const Prescription& prescription) {
    static const GlassCatalogue glasses = GlassCatalogue::shipped();
    check_prescription(prescription, {}, glasses, {});
    const Lens lens = make_lens(prescription, glasses);
    const Ray<double> ray{{0.0, 0.1, -10.0}, {0.0, 0.0, 1.0}};
    trace(at_wavelength<double>(lens, 550.0), ray);
}

void use(const GlassFile& file) {
    for (const Glass& glass : file.glasses) {
        refractive_index(glass.formula, clamped_to_range(glass, 550.0));
        internal_transmittance(glass, 550.0, 10.0);
        dn_dT_relative(glass, clamped_to_range(glass, 550.0));
    }
}

}  // namespace lensproof
