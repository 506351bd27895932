#include "engine/render/camera/exact_camera.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/base/infinity.h"
#include "engine/optics/convert_lens.h"
#include "engine/pupil/kept_maps.h"

namespace lensproof::render {

ExactCamera::ExactCamera(const optics::Lens& lens, const std::vector<double>& wavelengths_nm, double film_radius_mm,
                         const Cache& cache, bool meets_light_paths, TracePrecision precision,
                         std::shared_ptr<device::SharedDevice> device)
    : device_(std::move(device)),
      precision_(precision),
      lens_(optics::at_wavelengths<double>(lens, wavelengths_nm)),
      pupil_(pupil::kept_pupil_map(cache, lens_.at(), lens.is_rotationally_symmetric, film_radius_mm,
                                   {.device = device_.get()})),
      slices_(pupil_, lens_.wavelengths()),
      front_(pupil::front_sphere(lens_.at().front())),
      dust_(lens.dust) {
    if (precision != TracePrecision::in_double) {
        in_float_ = optics::at_wavelengths<float>(lens, wavelengths_nm);
    }
    if (meets_light_paths) {
        // Drawn over the whole front in a fifth of all cases, since the map is that of far light.
        entrance_ = pupil::kept_entrance_map(cache, lens_.at(), lens.is_rotationally_symmetric, kInfinity,
                                             {.defensive_fraction = 0.2, .device = device_.get()});
    }
    if (device_ && !device_->has_failed()) {
        put_on_device();
    }
}

void ExactCamera::put_on_device() {
    if (slices_.tables() == nullptr) {
        device_->refuse(
            "it draws from tables of the pupil, which lenses that are not rotationally symmetric have not, nor those "
            "at more than 256 wavelengths");
        return;
    }
    try {
        if (precision_ == TracePrecision::in_float) {
            on_device_.emplace(std::in_place_type<DeviceCamera<float>>, device_->device(), *in_float_, slices_);
        } else {
            on_device_.emplace(std::in_place_type<DeviceCamera<double>>, device_->device(), lens_, slices_);
        }
    } catch (const device::Error& error) {
        device_->refuse(error.what());
    }
}

ExactCamera::Paths::Paths(const ExactCamera& camera, const FilmSampling& film, const spectral::SpectralGrid& grid,
                          PathCarry carry)
    : heroes_(heroes_of(camera, film, carry)),
      others_(others_of(camera, film, grid, carry)),
      dust_(camera.dust_ ? &*camera.dust_ : nullptr),
      carry_(carry),
      is_shared_(film.filter.is_box()) {}

ExactCamera::Paths::Heroes ExactCamera::Paths::heroes_of(const ExactCamera& camera, const FilmSampling& film,
                                                         PathCarry carry) {
    const auto in = [&]<class T>(const optics::SpectralLens<T>& lens) -> Heroes {
        BasicLensPaths<T> paths(film, lens, camera.slices_);
        if (camera.on_device_ && film.filter.is_box()) {
            return DevicePaths<T>(*camera.device_, std::get<DeviceCamera<T>>(*camera.on_device_), film,
                                  camera.pupil_.plane_z(), carry != PathCarry::hero, std::move(paths));
        }
        return paths;
    };
    return camera.precision_ == TracePrecision::in_float ? in(*camera.in_float_) : in(camera.lens_);
}

ExactCamera::Paths::Others ExactCamera::Paths::others_of(const ExactCamera& camera, const FilmSampling& film,
                                                         const spectral::SpectralGrid& grid, PathCarry carry) {
    const auto in = [&]<class T>(const optics::SpectralLens<T>& lens, const optics::SpectralLens<double>* at_borders) {
        return BasicSharedRays<T>(grid, lens, camera.slices_, film.sensor, film.filter.is_box(), carry, {}, at_borders);
    };
    const bool are_in_double =
        camera.precision_ == TracePrecision::in_double ||
        (camera.precision_ == TracePrecision::heroes_in_double && carry == PathCarry::wavelengths_and_pdfs);
    if (are_in_double) {
        return in(camera.lens_, nullptr);
    }
    return in(*camera.in_float_, camera.precision_ == TracePrecision::heroes_in_double ? &camera.lens_ : nullptr);
}

void ExactCamera::Paths::start(const CameraPathRange& range) {
    std::visit([&](auto& heroes) { heroes.start(range); }, heroes_);
}

std::int64_t ExactCamera::Paths::started() const {
    return std::visit([](const auto& heroes) { return heroes.started(); }, heroes_);
}

bool ExactCamera::Paths::fill(CameraPathBuffer& buffer) {
    const bool is_filled = std::visit([&](auto& heroes) { return heroes.fill(buffer); }, heroes_);
    if (carry_ == PathCarry::wavelengths_and_pdfs || (carry_ == PathCarry::wavelengths && is_shared_)) {
        std::visit([&](auto& others) { others.weigh(buffer); }, others_);
    }
    if (carry_ != PathCarry::hero && !is_shared_) {
        buffer.leave_heroes_alone();
    }
    if (dust_ != nullptr) {
        for (std::size_t i = 0; i < static_cast<std::size_t>(buffer.size); ++i) {
            buffer.scale(i, dust_->clear(buffer.ray(i).origin));
        }
    }
    return is_filled;
}

/// The beam of an origin; from straight behind the lens beams have no frame.
std::optional<pupil::EntranceBeam> ExactCamera::beam_of(const LightOrigin& from) const {
    const auto beam =
        from.is_far ? std::optional(pupil::beam_along(front_, from.at)) : pupil::beam_from(front_, from.at);
    return beam && beam->axis.direction.z > -1.0 ? beam : std::nullopt;
}

double ExactCamera::band_position(std::uint16_t wavelength) const {
    return static_cast<double>(wavelength) / (lens_.wavelengths() - 1);
}

PathPdf ExactCamera::beam_pdf(const pupil::EntranceBeam& beam, Vec2d offset,
                              const spectral::PathWavelengths& path) const {
    const pupil::EntranceBeam far_beam = entrance_->beam(beam.axis.direction);
    const double mm2 = std::isfinite(beam.distance) ? 1.0 / beam.solid_angle_per_mm2(offset) : 1.0;
    std::array<double, spectral::kWavelengthsPerPath> positions{};
    std::ranges::transform(path.index, positions.begin(), [&](std::uint16_t index) { return band_position(index); });
    std::array<double, spectral::kWavelengthsPerPath> pdfs{};
    entrance_->pdfs(far_beam, positions, offset, pdfs);
    return over_heroes([&](std::size_t i) { return mm2 * pdfs[i]; });
}

FilmImportance ExactCamera::importance(const Sensor& sensor, const Ray<double>& ray,
                                       const spectral::PathWavelengths& path) const {
    FilmImportance found;
    importances(sensor, {&ray, 1}, {&path, 1}, {&found, 1});
    return found;
}

template <class T>
void ExactCamera::trace_importances(const optics::SpectralLens<T>& lens, const Sensor& sensor,
                                    std::span<const Ray<double>> rays, std::span<const spectral::PathWavelengths> paths,
                                    std::span<FilmImportance> found) const {
    constexpr std::size_t kMost = kSharedChunk;
    optics::RayBatch<T> traced(kSharedChunk);
    FilmMeetings meetings;
    for (std::size_t first = 0; first < rays.size(); first += kMost) {
        const std::size_t count = std::min(kMost, rays.size() - first);
        traced.size = static_cast<int>(count);
        for (std::size_t m = 0; m < spectral::kWavelengthsPerPath; ++m) {
            for (std::size_t i = 0; i < count; ++i) {
                traced.set(static_cast<int>(i), optics::convert_ray<T>(rays[first + i]));
                traced.wavelength[i] = paths[first + i].index[m];
            }
            optics::trace_batch<optics::Direction::forward>(lens, traced, {.carry = optics::Carry::transmittance});
            meet_film(lens.at(0).image_z, pupil_.plane_z(), path_kernels({}), traced, meetings);
            find_pupil_pdfs(slices_, std::span(traced.wavelength).first(count), path_kernels({}), meetings);
            for (std::size_t i = 0; i < count; ++i) {
                FilmImportance& of = found[first + i];
                const bool arrives = meetings.transmittance[i] >= 0.0;
                of.at_px[m] = arrives ? sensor.pixel(Vec2d{meetings.film_x[i], meetings.film_y[i]}) : Vec2d{};
                of.transmittance[m] = arrives ? meetings.transmittance[i] : 0.0;
                of.pdf[m] = arrives ? meetings.pupil_pdf[i] * meetings.per_etendue[i] : 0.0;
            }
        }
    }
    for (std::size_t i = 0; dust_ && i < rays.size(); ++i) {
        const double clear = dust_->clear(rays[i], lens_.at().front());
        for (double& transmittance : found[i].transmittance) {
            transmittance = clear * transmittance;
        }
    }
}

void ExactCamera::importances(const Sensor& sensor, std::span<const Ray<double>> rays,
                              std::span<const spectral::PathWavelengths> paths, std::span<FilmImportance> found) const {
    if (precision_ == TracePrecision::in_float) {
        trace_importances(*in_float_, sensor, rays, paths, found);
    } else {
        trace_importances(lens_, sensor, rays, paths, found);
    }
}

std::optional<LensSample> ExactCamera::sample(const LightOrigin& from, const spectral::PathWavelengths& path, double u,
                                              double v) const {
    const auto beam = beam_of(from);
    if (!beam) {
        return {};
    }
    const pupil::EntranceSample drawn =
        entrance_->sample(entrance_->beam(beam->axis.direction), band_position(path.index[0]), u, v);
    if (!(drawn.pdf > 0.0)) {
        return {};
    }
    const Ray<double> ray = beam->ray(drawn.offset);
    LensSample in{.ray = ray,
                  .direction = ray.direction,
                  .end = from.is_far
                             ? ray.origin
                             : from.at + std::hypot(beam->distance, drawn.offset.x, drawn.offset.y) * ray.direction,
                  .pdf = beam_pdf(*beam, drawn.offset, path)};
    return in.pdf.hero > 0.0 ? std::optional(in) : std::nullopt;
}

PathPdf ExactCamera::pdf(const LightOrigin& from, const Ray<double>& outwards,
                         const spectral::PathWavelengths& path) const {
    const auto beam = beam_of(from);
    if (!beam) {
        return {};
    }
    // Where the ray crosses the beam's plane, from its end at the lens, which is near.
    const Vec3d start = outwards.origin - front_.centre;
    const double along = dot(start, beam->axis.direction) / dot(outwards.direction, beam->axis.direction);
    const Vec3d crossing = start - along * outwards.direction;
    return beam_pdf(*beam, {dot(crossing, beam->across[0]), dot(crossing, beam->across[1])}, path);
}

}  // namespace lensproof::render
