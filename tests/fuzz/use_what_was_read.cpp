#include "tests/fuzz/use_what_was_read.h"

#include <utility>

#include "engine/base/input_error.h"
#include "engine/check/checker.h"
#include "engine/formats/glass/shipped_glasses.h"
#include "engine/optics/lens.h"
#include "engine/scene/geometry/geometry.h"
#include "engine/scene/scene_shapes.h"

namespace lensproof {

void use(const optics::Prescription& prescription) {
    const optics::GlassCatalogue& glasses = formats::shipped_glasses();
    check::check_prescription(prescription, {}, glasses, {});
    try {
        const optics::Lens lens = optics::make_lens(prescription, glasses);
        const Ray<double> ray{{0.0, 0.1, -10.0}, {0.0, 0.0, 1.0}};
        optics::trace(optics::at_wavelength<double>(lens, 550.0), ray);
    } catch (const InputError&) {
        return;  // refused, as the checker has said
    }
}

void use(const formats::GlassFile& file) {
    for (const optics::Glass& glass : file.glasses) {
        optics::refractive_index(glass.formula, glass.min_wavelength_nm);
        optics::internal_transmittance(glass, 550.0, 10.0);
        optics::dn_dT_relative(glass, glass.max_wavelength_nm);
    }
}

void use(const render::SceneSetup& setup) {
    try {
        scene::SceneShapes shapes = scene::load_shapes(setup.scene);
        const scene::SceneGeometry geometry(std::move(shapes.shapes), std::move(shapes.objects));
        const AffineMap camera = render::camera_to_world(setup.camera);
        scene::intersect(geometry, camera.translation, camera.linear * Vec3d{0.0, 0.0, 1.0}, 0.0, 1e12);
    } catch (const InputError&) {
        return;  // refused, as a render would
    }
}

}  // namespace lensproof
