// One reader (LENSPROOF_READER) on bytes from libFuzzer or from the saved corpus. It may refuse them, by an InputError,
// and nothing else; what it takes must survive being made into a lens, traced and checked too.
#include <cstddef>
#include <cstdint>
#include <string>

#include "engine/check/checker.h"
#include "engine/io/glass/glass_file.h"
#include "engine/io/input_error.h"
#include "engine/optics/lens.h"
#include LENSPROOF_READER_HEADER

namespace {

using namespace lensproof;

[[maybe_unused]] void use(const Prescription& prescription) {
    static const GlassCatalogue glasses = GlassCatalogue::shipped();
    check_prescription(prescription, {}, glasses, {});
    const Lens lens = make_lens(prescription, glasses);
    const Ray<double> ray{{0.0, 0.1, -10.0}, {0.0, 0.0, 1.0}};
    trace(at_wavelength<double>(lens, 550.0), ray);
}

[[maybe_unused]] void use(const GlassFile& file) {
    for (const Glass& glass : file.glasses) {
        refractive_index(glass.formula, clamped_to_range(glass, 550.0));
        internal_transmittance(glass, 550.0, 10.0);
        dn_dT_relative(glass, clamped_to_range(glass, 550.0));
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    try {
        use(LENSPROOF_READER(std::string(reinterpret_cast<const char*>(data), size), "fuzzed"));
    } catch (const InputError&) {
        return 0;  // named and refused
    }
    return 0;
}
