#include <cstdio>

#include "engine/formats/prescription/load_lens.h"
#include "engine/optics/trace.h"

int main() {
    using namespace lensproof;
    const optics::Lens lens = formats::load_lens("tessar");
    const optics::TracedRay<double> ray = optics::trace(optics::at_wavelength<double>(lens, 587.5618),
                                                        Ray<double>{.origin = {0, 3, -10}, .direction = {0, 0, 1}});
    std::printf("%.17g %.17g %.17g\n", ray.ray.origin.x, ray.ray.origin.y, ray.ray.origin.z);
}
