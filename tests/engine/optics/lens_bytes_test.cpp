#include "engine/optics/lens_bytes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <set>
#include <vector>

#include "engine/formats/prescription/load_lens.h"
#include "engine/optics/lens.h"
#include "engine/spectral/wavelengths.h"

namespace lensproof::optics::lens_bytes_test {

std::string bytes_of(const TraceLens<double>& lens) {
    std::string bytes;
    append_lens_bytes(bytes, lens);
    return bytes;
}

TraceLens<double> with_everything() {
    TraceLens<double> lens = at_wavelength<double>(formats::load_lens("tessar"), spectral::kLineD);
    lens.surfaces[2].special = 0;
    lens.specials.emplace_back();
    lens.specials[0].coating.layers = {{1.38, 0.25}, {2.1, 0.5}};
    lens.specials[0].mask = StopMask(PolygonStop{.blades = 5, .curvature = 0.5, .rotation_deg = 10.0});
    return lens;
}

void nudge(double& number) {
    number = std::nextafter(number, HUGE_VAL);
}

// Whatever changes in a lens, by as little as an ulp, it leaves bytes of its own; the same file read twice does not.
TEST(LensBytes, TellEveryLensFromEveryOther) {
    using Change = std::function<void(TraceLens<double>&)>;
    std::vector<Change> changes = {
        [](auto&) {},
        [](auto& lens) { nudge(lens.image_z); },
        [](auto& lens) {
            lens.attenuation = {0.0, 1e-3};
        },
        [](auto& lens) {
            lens.attenuation = {0.0, 2e-3};
        },
        [](auto& lens) { lens.surfaces.pop_back(); },
        [](auto& lens) { lens.specials.emplace_back(); },
        [](auto& lens) { nudge(lens.surfaces[1].curvature); },
        [](auto& lens) { nudge(lens.surfaces[1].vertex_z); },
        [](auto& lens) { nudge(lens.surfaces[1].semi_diameter_squared); },
        [](auto& lens) { nudge(lens.surfaces[1].index_before); },
        [](auto& lens) { nudge(lens.surfaces[1].index_after); },
        [](auto& lens) { lens.surfaces[1].is_stop = true; },
        [](auto& lens) { lens.surfaces[1].special = 0; },
        [](auto& lens) { lens.specials[0].has_shape = true; },
        [](auto& lens) { nudge(lens.specials[0].shape.curvature); },
        [](auto& lens) { nudge(lens.specials[0].shape.conic); },
        [](auto& lens) { nudge(lens.specials[0].shape.asphere[0]); },
        [](auto& lens) { nudge(lens.specials[0].shape.asphere[9]); },
        [](auto& lens) { lens.specials[0].shape.terms = 1; },
        [](auto& lens) { lens.specials[0].shape.odd_terms = 1; },
        [](auto& lens) { lens.specials[0].shape.odd_terms = 2; },
        [](auto& lens) {
            lens.specials[0].shape.odd_terms = 2;
            nudge(lens.specials[0].shape.odd_asphere[1]);
        },
        [](auto& lens) { lens.specials[0].shape.along_normal = true; },
        [](auto& lens) {
            lens.specials[0].shape.along_normal = true;
            lens.specials[0].shape.odd_terms = 2;
        },
        [](auto& lens) { lens.specials[0].shape.is_toroid = true; },
        [](auto& lens) { nudge(lens.specials[0].shape.curvature_x); },
        [](auto& lens) { nudge(lens.specials[0].vertex.x); },
        [](auto& lens) { nudge(lens.specials[0].vertex.y); },
        [](auto& lens) { nudge(lens.specials[0].axes[0].y); },
        [](auto& lens) { nudge(lens.specials[0].axes[2].z); },
        [](auto& lens) { nudge(lens.specials[0].coating.layers[1].index); },
        [](auto& lens) { nudge(lens.specials[0].coating.layers[1].thickness); },
        [](auto& lens) { lens.specials[0].coating.layers.pop_back(); },
        [](auto& lens) { lens.specials[0].coating.reflectance = 0.0; },
        [](auto& lens) { lens.specials[0].mask = {}; },
        [](auto& lens) { lens.specials[0].mask = StopMask(PolygonStop{.blades = 6, .curvature = 0.5}); },
        [](auto& lens) {
            lens.specials[0].mask = StopMask(PolygonStop{.blades = 5, .curvature = 0.5, .rotation_deg = 11.0});
        }};
    std::set<std::string> different;
    for (const Change& change : changes) {
        TraceLens<double> lens = with_everything();
        change(lens);
        different.insert(bytes_of(lens));
    }
    EXPECT_EQ(different.size(), changes.size());
    EXPECT_EQ(bytes_of(with_everything()), bytes_of(with_everything()));
}

}  // namespace lensproof::optics::lens_bytes_test
