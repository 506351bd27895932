#include "engine/render/stray/lights_in_lens.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "engine/base/input_error.h"
#include "engine/pupil/entrance_beam.h"

namespace lensproof::render {

namespace {

/// Lens space, mm.
struct LensBody {
    optics::SurfaceShape<double> front;
    double front_rim = 0.0;
    double radius = 0.0;
    double end_z = 0.0;

    explicit LensBody(const optics::Lens& lens)
        : front(lens.surfaces.front().shape), front_rim(lens.surfaces.front().semi_diameter), end_z(lens.image_z) {
        for (const optics::LensSurface& surface : lens.surfaces) {
            radius = std::max({radius, surface.semi_diameter, surface.rim, surface.tube_behind});
            end_z = std::max(end_z, surface.vertex_z);
        }
    }

    [[nodiscard]] bool holds(const Vec3d& point) const {
        const double from_axis = std::hypot(point.x, point.y);
        const double inwards = from_axis > front_rim ? front_rim / from_axis : 1.0;
        return from_axis <= radius && point.z < end_z &&
               point.z > optics::sag(front, inwards * point.x, inwards * point.y);
    }
};

}  // namespace

void refuse_lights_in_lens(const Camera& camera, const scene::Lights& lights, const std::vector<std::string>& places,
                           bool meets_light_paths) {
    if (!camera.lens()) {
        return;
    }
    const LensBody body(*camera.lens());
    std::optional<pupil::BoundingSphere> near;
    if (meets_light_paths) {
        near =
            pupil::front_sphere(optics::at_wavelength<double>(*camera.lens(), camera.lens()->reference_wavelength_nm));
    }
    for (std::size_t i = 0; i < lights.size(); ++i) {
        for (const Vec3d& point : lights.points_of(i)) {
            const Vec3d at = camera.in_lens_space({.at = point}).at;
            if (body.holds(at)) {
                throw InputError(
                    fmt::format("{}: shines from inside the lens, from {:.4g} mm behind its first vertex and {:.4g} mm "
                                "beside its axis",
                                places[i], at.z, std::hypot(at.x, at.y)));
            }
            if (near && length(at - near->centre) < near->radius) {
                throw InputError(
                    fmt::format("{}: shines from {:.4g} mm in front of the lens, where light paths cannot begin; "
                                "expected {:.4g} mm or "
                                "more from the middle of the first surface's rim, or passes \"imaged\" and \"direct\" "
                                "by camera paths",
                                places[i], -at.z, near->radius));
            }
        }
    }
}

}  // namespace lensproof::render
