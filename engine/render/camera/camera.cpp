#include "engine/render/camera/camera.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "engine/base/bytes.h"
#include "engine/base/hash.h"
#include "engine/base/input_error.h"
#include "engine/optics/lens_bytes.h"
#include "engine/spectral/illuminant.h"

namespace lensproof::render {

namespace {

/// All that light among a lens's walls meets beside its glass: nothing where they are black.
void append_barrel_bytes(std::string& bytes, const optics::Lens& lens) {
    if (lens.barrel.is_black()) {
        return;
    }
    const auto& [tube, edges, blades] = lens.barrel;
    for (const auto& [albedo, gloss, roughness] : {tube, edges, blades}) {
        append_bytes(bytes, albedo, gloss, roughness);
    }
    for (const optics::LensSurface& surface : lens.surfaces) {
        append_bytes(bytes, surface.rim, surface.tube_behind);
    }
}

/// Dust on the front: nothing where there is none.
void append_dust_bytes(std::string& bytes, const optics::Lens& lens) {
    if (const auto& dust = lens.dust) {
        append_bytes(bytes, dust->covered->size_x, dust->covered->size_y, dust->semi_diameter, dust->albedo,
                     dust->through);
        for (const float covered : dust->covered->values) {
            append_bytes(bytes, covered);
        }
    }
}

}  // namespace

void CameraPaths::start(const CameraPathRange& range) {
    std::visit([&](auto& optics) { optics.start(range); }, optics_);
}

bool CameraPaths::fill(CameraPathBuffer& buffer) {
    return std::visit([&](auto& optics) { return optics.fill(buffer); }, optics_);
}

std::int64_t CameraPaths::started() const {
    return std::visit([](const auto& optics) { return optics.started(); }, optics_);
}

Camera::Camera(const CameraSettings& settings, const SpectralSampling& sampling, const PixelFilter& filter,
               const Cache& cache, bool meets_light_paths, std::shared_ptr<device::SharedDevice> device)
    : Camera(settings, settings.focal_length_mm ? std::nullopt : std::optional(camera_lens(settings)), sampling, filter,
             cache, meets_light_paths, std::move(device)) {}

Camera::Camera(const CameraSettings& settings, std::optional<optics::Lens> lens, const SpectralSampling& sampling,
               const PixelFilter& filter, const Cache& cache, bool meets_light_paths,
               std::shared_ptr<device::SharedDevice> device)
    : settings_(settings),
      cache_(cache),
      pose_(camera_to_world(settings)),
      lens_(std::move(lens)),
      grid_(make_grid(sampling)),
      film_(make_film(sampling.layers, filter)),
      colours_(spectral::rgb_space(settings.response, spectral::illuminant(settings.white_balance))),
      optics_(make_optics(meets_light_paths, std::move(device))) {}

spectral::SpectralGrid Camera::make_grid(const SpectralSampling& sampling) {
    SpectralSampling band = sampling;
    if (lens_) {
        const optics::WavelengthRange range = optics::wavelength_range(*lens_);
        band.min_nm = std::max(sampling.min_nm, range.min_nm);
        band.max_nm = std::min(sampling.max_nm, range.max_nm);
        if (!(band.min_nm < band.max_nm)) {
            throw InputError(
                fmt::format("wavelengths of {} to {} nm: the glasses of {} are known from {} to {} nm only",
                            sampling.min_nm, sampling.max_nm, lens_->name, range.min_nm, range.max_nm));
        }
        if (band.min_nm != sampling.min_nm || band.max_nm != sampling.max_nm) {
            clamp_note_ = fmt::format("wavelengths clamped to {} to {} nm, where the glasses of {} are known",
                                      band.min_nm, band.max_nm, lens_->name);
        }
    }
    return {spectral::wavelength_strata(band.min_nm, band.max_nm, sampling.strata())};
}

namespace {

/// Of a model that traces surfaces.
TracePrecision precision_of(LensModel model) {
    switch (model) {
        case LensModel::exact_double:
            return TracePrecision::in_double;
        case LensModel::exact_float:
            return TracePrecision::in_float;
        default:
            return TracePrecision::heroes_in_double;
    }
}

}  // namespace

Camera::Optics Camera::make_optics(bool meets_light_paths, std::shared_ptr<device::SharedDevice> device) const {
    if (device && !traces_surfaces(settings_.model)) {
        device->refuse(fmt::format("it traces lenses, and the camera's model is {}", name_of(settings_.model)));
    } else if (device && !film_.filter.is_box()) {
        device->refuse(fmt::format("it draws film points from the box, and the filter is {}", film_.filter.name()));
    }
    const std::vector<double> wavelengths = grid_.strata.midpoints();
    // Pixels are areas: the corner of what the corner pixel's filter reaches is the farthest point sampled.
    const double film_radius_mm = sensor().half_diagonal_mm(film_.filter.radius_px() - 0.5);
    if (settings_.model == LensModel::polynomial) {
        return Optics(std::in_place_type<PolynomialCamera>, lens_.value(), wavelengths, film_radius_mm, cache_,
                      meets_light_paths);
    }
    if (traces_surfaces(settings_.model)) {
        return Optics(std::in_place_type<ExactCamera>, lens_.value(), wavelengths, film_radius_mm, cache_,
                      meets_light_paths, precision_of(settings_.model), std::move(device));
    }
    if (settings_.model == LensModel::thin_lens_profile || settings_.model == LensModel::pinhole_profile) {
        return Optics(std::in_place_type<ProfileCamera>,
                      kept_profile(cache_, lens_.value(), wavelengths, film_radius_mm),
                      ProfileOpening{.is_pinhole = settings_.model == LensModel::pinhole_profile,
                                     .focus_z = -settings_.focus_distance_mm});
    }
    std::vector<GaussianOptics> at;
    std::ranges::transform(wavelengths, std::back_inserter(at), [&](double nm) {
        return lens_ ? gaussian_optics(*lens_, settings_.model, nm)
                     : gaussian_optics(settings_.focal_length_mm.value(), settings_.f_number,
                                       settings_.focus_distance_mm, settings_.model);
    });
    return Optics(std::in_place_type<IdealCamera>, std::move(at));
}

CameraPaths Camera::paths(std::uint64_t seed, PathCarry carry) const {
    const FilmSampling film{.sensor = sensor(), .seed = seed, .filter = film_.filter};
    return std::visit(
        [&]<class OfModel>(const OfModel& optics) {
            return CameraPaths(typename OfModel::Paths(optics, film, grid_, carry));
        },
        optics_);
}

FilmImportance Camera::importance(const Ray<double>& ray, const spectral::PathWavelengths& path) const {
    return std::visit([&](const auto& optics) { return optics.importance(sensor(), ray, path); }, optics_);
}

void Camera::importances(std::span<const Ray<double>> rays, std::span<const spectral::PathWavelengths> paths,
                         std::span<FilmImportance> found) const {
    if (const auto* exact = std::get_if<ExactCamera>(&optics_)) {
        exact->importances(sensor(), rays, paths, found);
        return;
    }
    for (std::size_t i = 0; i < rays.size(); ++i) {
        found[i] = importance(rays[i], paths[i]);
    }
}

LightOrigin Camera::in_lens_space(const LightOrigin& from) const {
    return {scene::camera_to_lens(from.is_far ? transposed_times(pose_.linear, from.at) : point_before(pose_, from.at)),
            from.is_far};
}

std::optional<LensSample> Camera::sample(const LightOrigin& from, const spectral::PathWavelengths& path, double u,
                                         double v) const {
    const LightOrigin origin = in_lens_space(from);
    auto in = std::visit([&](const auto& optics) { return optics.sample(origin, path, u, v); }, optics_);
    if (in) {
        in->direction = pose_.linear * scene::camera_to_lens(in->direction);
        in->end = map_point(pose_, scene::camera_to_lens(in->end));
    }
    return in;
}

PathPdf Camera::pdf(const LightOrigin& from, const Ray<double>& outwards, const spectral::PathWavelengths& path) const {
    const LightOrigin origin = in_lens_space(from);
    return std::visit([&](const auto& optics) { return optics.pdf(origin, outwards, path); }, optics_);
}

double Camera::film_area_mm2() const {
    return sensor().width * sensor().pixel_pitch_mm * sensor().height * sensor().pixel_pitch_mm;
}

EntranceRatio Camera::entrance_ratio(const PathPdf& entrance, const PathPdf& drawn) const {
    const auto of = [&](double in, double out) { return out > 0.0 ? film_area_mm2() * in / out : 0.0; };
    return {.shared = of(entrance.shared, drawn.shared), .hero = of(entrance.hero, drawn.hero)};
}

std::string Camera::hash() const {
    std::string bytes;
    const auto* polynomial = std::get_if<PolynomialCamera>(&optics_);
    const auto* exact = polynomial != nullptr ? &polynomial->exact() : std::get_if<ExactCamera>(&optics_);
    if (exact != nullptr) {
        for (const optics::TraceLens<double>& lens : exact->lens().at()) {
            optics::append_lens_bytes(bytes, lens);
        }
        append_barrel_bytes(bytes, *lens_);
        append_dust_bytes(bytes, *lens_);
        bytes += exact->precision() == TracePrecision::in_float           ? "in float"
                 : exact->precision() == TracePrecision::heroes_in_double ? "heroes in double"
                                                                          : "";
        bytes += polynomial != nullptr ? polynomial->polynomial().serialized() : "";
    } else if (const auto* profile = std::get_if<ProfileCamera>(&optics_)) {
        bytes = profile->bytes();
    } else {
        for (const GaussianOptics& at : std::get<IdealCamera>(optics_).at()) {
            bytes += fmt::format("{} {} {} {} {} {} {} {} {} {}\n", at.film_z, at.pupil_z, at.pupil_radius_mm,
                                 at.is_pinhole, at.object_z, at.h_h, at.h_s, at.s_h, at.s_s, at.transmittance);
        }
    }
    return hash_text(bytes);
}

}  // namespace lensproof::render
