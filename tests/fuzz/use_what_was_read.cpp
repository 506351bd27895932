#include "tests/fuzz/use_what_was_read.h"

#include <utility>

#include "engine/base/input_error.h"
#include "engine/check/checker.h"
#include "engine/formats/glass/shipped_glasses.h"
#include "engine/optics/lens.h"
#include "engine/scene/geometry.h"
#include "engine/scene/scene_shapes.h"

namespace lensproof {

void use(const Prescription& prescription) {
    static const GlassCatalogue glasses = shipped_glasses();
    check_prescription(prescription, {}, glasses, {});
    try {
        const Lens lens = make_lens(prescription, glasses);
        const Ray<double> ray{{0.0, 0.1, -10.0}, {0.0, 0.0, 1.0}};
        trace(at_wavelength<double>(lens, 550.0), ray);
    } catch (const InputError&) {
        return;  // refused, as the checker has said
    }
}

void use(const GlassFile& file) {
    for (const Glass& glass : file.glasses) {
        refractive_index(glass.formula, glass.min_wavelength_nm);
        internal_transmittance(glass, 550.0, 10.0);
        dn_dT_relative(glass, glass.max_wavelength_nm);
    }
}

void use(const SceneSetup& setup) {
    try {
        SceneShapes shapes = load_shapes(setup.scene);
        const SceneGeometry geometry(std::move(shapes.shapes), std::move(shapes.objects));
        const RigidMotion camera = camera_to_world(setup.view);
        intersect(geometry, camera.translation, rotate(camera, {0.0, 0.0, 1.0}), 0.0, 1e12);
    } catch (const InputError&) {
        return;  // refused, as a render would
    }
}

}  // namespace lensproof
