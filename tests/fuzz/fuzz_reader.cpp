// One reader (LENSPROOF_READER) on bytes from libFuzzer or from the saved corpus. It may refuse them, by an InputError,
// and nothing else; what it takes must survive being made into a lens, traced and checked too.
#include <cstddef>
#include <cstdint>
#include <string>
#include <type_traits>

#include "engine/io/input_error.h"
#include "engine/optics/lens.h"
#include LENSPROOF_READER_HEADER

namespace {

using namespace lensproof;

void use(const Prescription& prescription) {
    const Lens lens = make_lens(prescription, {});
    const Ray<double> ray{{0.0, 0.1, -10.0}, {0.0, 0.0, 1.0}};
    trace(at_wavelength<double>(lens, 550.0), ray);
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
