#include "engine/render/ideal_camera.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <utility>

#include "engine/base/input_error.h"
#include "engine/optics/paraxial.h"
#include "engine/render/film_points.h"
#include "engine/spectral/wavelengths.h"

namespace lensproof::render {

namespace {

/// Of a ray along the axis; 1 where it does not come through (a stop with a central obstruction).
double axial_transmittance(const optics::TraceLens<double>& lens) {
    const optics::TracedRay<double> axis =
        optics::trace<optics::Direction::reverse>(lens, {{0.0, 0.0, lens.image_z}, {0.0, 0.0, -1.0}});
    return axis.status == optics::RayStatus::ok ? axis.transmittance : 1.0;
}

GaussianCamera thin_lens(const optics::TraceLens<double>& lens, const optics::ParaxialData& data) {
    return {.film_z = lens.image_z - lens.surfaces.back().vertex_z - data.rear_principal_z,
            .pupil_z = 0.0,
            .pupil_radius_mm = 0.5 * data.entrance_pupil_diameter,
            .object_z = data.front_principal_z,
            .s_h = 1.0 / data.efl};
}

GaussianCamera paraxial_lens(const optics::Lens& lens, const optics::TraceLens<double>& traced,
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

GaussianCamera gaussian_camera(const optics::Lens& lens, scene::LensModel model, double wavelength_nm) {
    const optics::TraceLens<double> traced = optics::at_wavelength<double>(lens, wavelength_nm);
    // What has one focal length has that of the line by which lenses are focused and stopped down.
    const optics::TraceLens<double> reference =
        model == scene::LensModel::paraxial ? traced : optics::at_wavelength<double>(lens, spectral::kLineD);
    const optics::ParaxialData data = optics::paraxial_data(reference);
    if (!std::isfinite(data.efl) || !std::isfinite(data.entrance_pupil_diameter)) {
        throw InputError(fmt::format("{} has no focal length or no entrance pupil, which the {} model needs", lens.name,
                                     scene::name_of(model)));
    }
    GaussianCamera camera =
        model == scene::LensModel::paraxial ? paraxial_lens(lens, reference, data) : thin_lens(reference, data);
    camera.is_pinhole = model == scene::LensModel::pinhole;
    camera.transmittance = axial_transmittance(traced);
    return camera;
}

GaussianCamera gaussian_camera(double focal_length_mm, double f_number, double focus_distance_mm,
                               scene::LensModel model) {
    if (model != scene::LensModel::thin_lens && model != scene::LensModel::pinhole) {
        throw InputError(fmt::format("the {} model needs a lens", scene::name_of(model)));
    }
    if (!(focus_distance_mm > focal_length_mm)) {
        throw InputError(
            fmt::format("a thin lens of {} mm cannot be focused at {} mm, expected more than its focal length",
                        focal_length_mm, focus_distance_mm));
    }
    return {.film_z = 1.0 / (1.0 / focal_length_mm - 1.0 / focus_distance_mm),
            .pupil_radius_mm = 0.5 * focal_length_mm / f_number,
            .is_pinhole = model == scene::LensModel::pinhole,
            .s_h = 1.0 / focal_length_mm};
}

IdealPathProducer::IdealPathProducer(IdealPathSource source)
    : source_(std::move(source)), kernels_(&path_kernels<double>({})), starts_(std::make_unique<PathStarts>()) {}

void IdealPathProducer::start(const CameraPathRange& range) {
    cursor_ = {.pixel = range.first_pixel, .sample = 0, .first_sample = range.first_sample, .samples = range.samples};
    end_pixel_ = range.first_pixel + (range.samples > 0 ? range.pixels : 0);
}

bool IdealPathProducer::fill(CameraPathBuffer<double>& buffer) {
    buffer.size = 0;
    while (cursor_.pixel < end_pixel_ && buffer.size < buffer.capacity) {
        const std::uint64_t left = std::uint64_t{end_pixel_ - cursor_.pixel} * cursor_.samples - cursor_.sample;
        const int count =
            static_cast<int>(std::min<std::uint64_t>(left, std::min(buffer.capacity - buffer.size, kPathChunk)));
        kernels_->draw_samples(
            {.sensor = source_.sensor, .seed = source_.seed, .wavelengths = static_cast<int>(source_.at->size())},
            count, cursor_, *starts_);
        draw_from_filter(source_.filter, source_.sensor, *starts_, filter_weight_);
        for (int i = 0; i < count; ++i) {
            append(static_cast<std::size_t>(i), buffer);
        }
        started_ += count;
    }
    return buffer.size > 0;
}

void IdealPathProducer::append(std::size_t sample, CameraPathBuffer<double>& buffer) {
    const GaussianCamera& camera = (*source_.at)[starts_->wavelength[sample]];
    const double radius = camera.is_pinhole ? 0.0 : camera.pupil_radius_mm * std::sqrt(starts_->pupil_u[sample]);
    const double angle = 2.0 * std::numbers::pi * starts_->pupil_v[sample];
    const Vec2d h{radius * std::cos(angle), radius * std::sin(angle)};
    const double way_z = camera.pupil_z - camera.film_z;
    const Vec3d way{h.x - starts_->film_x[sample], h.y - starts_->film_y[sample], way_z};
    const Vec2d s{way.x / way_z, way.y / way_z};
    const double distance2 = dot(way, way);
    const double area = std::numbers::pi * camera.pupil_radius_mm * camera.pupil_radius_mm;
    const Vec3d direction =
        normalized(Vec3d{-(camera.s_h * h.x + camera.s_s * s.x), -(camera.s_h * h.y + camera.s_s * s.y), -1.0});

    const auto at = static_cast<std::size_t>(buffer.size++);
    buffer.pixel[at] = starts_->pixel[sample];
    buffer.sample[at] = starts_->sample[sample];
    buffer.wavelength[at] = starts_->wavelength[sample];
    buffer.film_x[at] = starts_->film_x[sample];
    buffer.film_y[at] = starts_->film_y[sample];
    buffer.weight[at] = camera.transmittance * way_z * way_z / (distance2 * distance2) * area * filter_weight_[sample];
    buffer.origin.x[at] = camera.h_h * h.x + camera.h_s * s.x;
    buffer.origin.y[at] = camera.h_h * h.y + camera.h_s * s.y;
    buffer.origin.z[at] = camera.object_z;
    buffer.direction.x[at] = direction.x;
    buffer.direction.y[at] = direction.y;
    buffer.direction.z[at] = direction.z;
}

}  // namespace lensproof::render
