#include "engine/render/camera/gaussian_optics.h"

#include <fmt/format.h>

#include <cmath>

#include "engine/base/input_error.h"
#include "engine/optics/paraxial.h"
#include "engine/spectral/wavelengths.h"

namespace lensproof::render {

namespace {

GaussianOptics thin_lens(const optics::TraceLens<double>& lens, const optics::ParaxialData& data) {
    return {.film_z = lens.image_z - lens.surfaces.back().vertex_z - data.rear_principal_z,
            .pupil_z = 0.0,
            .pupil_radius_mm = 0.5 * data.entrance_pupil_diameter,
            .object_z = data.front_principal_z,
            .s_h = 1.0 / data.front_efl};
}

GaussianOptics paraxial_lens(const optics::Lens& lens, const optics::TraceLens<double>& traced,
                             const optics::ParaxialData& data) {
    const double exit_pupil_z = data.exit_pupil_z;  // from the last vertex
    if (!std::isfinite(exit_pupil_z) || !std::isfinite(data.exit_pupil_diameter)) {
        throw InputError(fmt::format(
            "the exit pupil of {} lies at infinity, which the paraxial model does not cover; try exact or thin-lens",
            lens.name));
    }
    const int last = static_cast<int>(traced.surfaces.size()) - 1;
    const auto backwards = [&](double height, double slope) {
        return optics::trace_paraxial(traced, optics::ParaxialRay{height - exit_pupil_z * slope, slope}, last, 0);
    };
    const optics::ParaxialRay of_height = backwards(1.0, 0.0);
    const optics::ParaxialRay of_slope = backwards(0.0, 1.0);
    return {.film_z = traced.image_z,
            .pupil_z = traced.surfaces.back().vertex_z + exit_pupil_z,
            .pupil_radius_mm = 0.5 * std::abs(data.exit_pupil_diameter),
            .object_z = traced.surfaces.front().vertex_z,
            .h_h = of_height.height,
            .h_s = of_slope.height,
            .s_h = of_height.slope,
            .s_s = of_slope.slope};
}

}  // namespace

double axial_transmittance(const optics::Lens& lens, double wavelength_nm) {
    const optics::TraceLens<double> traced = optics::at_wavelength<double>(lens, wavelength_nm);
    const optics::TracedRay<double> axis = optics::trace<optics::Direction::reverse>(
        traced, {{0.0, 0.0, traced.image_z}, {0.0, 0.0, -lens.final_heading()}});
    return axis.status == optics::RayStatus::ok ? axis.transmittance : 1.0;
}

GaussianOptics gaussian_optics(const optics::Lens& lens, LensModel model, double wavelength_nm) {
    const optics::TraceLens<double> traced = optics::at_wavelength<double>(lens, wavelength_nm);
    // What has one focal length has that of the line by which lenses are focused and stopped down.
    const optics::TraceLens<double> reference =
        model == LensModel::paraxial ? traced : optics::at_wavelength<double>(lens, spectral::kLineD);
    const optics::ParaxialData data = optics::paraxial_data(reference);
    if (!std::isfinite(data.efl) || !std::isfinite(data.entrance_pupil_diameter)) {
        throw InputError(fmt::format("{} has no focal length or no entrance pupil, which the {} model needs", lens.name,
                                     name_of(model)));
    }
    GaussianOptics camera =
        model == LensModel::paraxial ? paraxial_lens(lens, reference, data) : thin_lens(reference, data);
    camera.is_pinhole = model == LensModel::pinhole;
    camera.transmittance = axial_transmittance(lens, wavelength_nm);
    return camera;
}

GaussianOptics gaussian_optics(double focal_length_mm, double f_number, double focus_distance_mm, LensModel model) {
    if (model != LensModel::thin_lens && model != LensModel::pinhole) {
        throw InputError(fmt::format("the {} model needs a lens", name_of(model)));
    }
    if (!(focus_distance_mm > focal_length_mm)) {
        throw InputError(
            fmt::format("a thin lens of {} mm cannot be focused at {} mm, expected more than its focal length",
                        focal_length_mm, focus_distance_mm));
    }
    return {.film_z = 1.0 / (1.0 / focal_length_mm - 1.0 / focus_distance_mm),
            .pupil_radius_mm = 0.5 * focal_length_mm / f_number,
            .is_pinhole = model == LensModel::pinhole,
            .s_h = 1.0 / focal_length_mm};
}

}  // namespace lensproof::render
