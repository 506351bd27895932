#include "engine/render/camera/polynomial_camera.h"

#include <utility>

#include "engine/polynomial/polynomial_fit.h"

namespace lensproof::render {

PolynomialCamera::PolynomialCamera(const optics::Lens& lens, const std::vector<double>& wavelengths_nm,
                                   double film_radius_mm, const Cache& cache, bool meets_light_paths)
    : exact_(lens, wavelengths_nm, film_radius_mm, cache, meets_light_paths),
      polynomial_(polynomial::kept_polynomial(cache, lens, wavelengths_nm, exact_.pupil().map(), film_radius_mm)) {}

/// Outside it there is the pdf of the defence alone, over the whole disc, which no region fills.
bool PolynomialCamera::is_in_region(double pdf) const {
    const pupil::RegionMap& regions = exact_.pupil().map().regions();
    return pdf * regions.disc().area() > 1.5 * regions.defensive_fraction();
}

PolynomialCamera::Paths::Paths(const PolynomialCamera& camera, const FilmSampling& film,
                               const spectral::SpectralGrid& grid, PathCarry carry)
    : samples_(film, camera.exact_.lens().wavelengths()),
      camera_(&camera),
      kernels_(&path_kernels({})),
      tables_(camera.polynomial_.tables()),
      rays_(kPathChunk),
      sensor_(film.sensor),
      grid_(grid),
      carry_(carry) {}

bool PolynomialCamera::Paths::fill(CameraPathBuffer& buffer) {
    const bool is_filled = samples_.fill(buffer, [&](PathStarts& starts) {
        const polynomial::PolynomialFrame& frame = camera_->polynomial_.frame();
        draw_pupil_points(starts);
        kernels_->aim_rays(frame.film_z, frame.pupil_z, starts, rays_);
        polynomial::polynomial_kernels().find_exits(tables_,
                                                    {.film_x = starts.film_x.data(),
                                                     .film_y = starts.film_y.data(),
                                                     .pupil_x = starts.pupil_x.data(),
                                                     .pupil_y = starts.pupil_y.data(),
                                                     .wavelength = starts.wavelength.data(),
                                                     .size = starts.size},
                                                    rays_);
        append(starts, buffer);
    });
    if (carry_ != PathCarry::hero) {
        weigh(buffer);
    }
    return is_filled;
}

void PolynomialCamera::Paths::draw_pupil_points(PathStarts& starts) {
    const pupil::PupilSlices& pupil = camera_->exact_.pupil();
    const pupil::PupilSliceTables* tables = pupil.tables();
    if (tables != nullptr) {
        kernels_->draw_pupil_points(*tables, starts);
    }
    for (std::size_t i = 0; i < static_cast<std::size_t>(starts.size); ++i) {
        if (tables == nullptr || starts.pupil_area[i] < 0.0) {
            const pupil::PupilDraw<double> draw = pupil.sample(
                {starts.film_x[i], starts.film_y[i]}, starts.wavelength[i], starts.pupil_u[i], starts.pupil_v[i]);
            starts.pupil_x[i] = draw.point.x;
            starts.pupil_y[i] = draw.point.y;
            starts.pupil_area[i] = draw.area > 0.0 && camera_->is_in_region(1.0 / draw.area) ? draw.area : 0.0;
        }
        started_ += starts.pupil_area[i] > 0.0 ? 1 : 0;
    }
}

void PolynomialCamera::Paths::append(const PathStarts& starts, CameraPathBuffer& buffer) const {
    for (std::size_t i = 0; i < static_cast<std::size_t>(starts.size); ++i) {
        if (!(starts.pupil_area[i] > 0.0) || !(rays_.transmittance[i] > 0.0)) {
            continue;
        }
        const auto at = static_cast<std::size_t>(buffer.size++);
        buffer.pixel[at] = starts.pixel[i];
        buffer.sample[at] = starts.sample[i];
        buffer.wavelength[at] = starts.wavelength[i];
        buffer.film_x[at] = starts.film_x[i];
        buffer.film_y[at] = starts.film_y[i];
        buffer.weight[at] = rays_.transmittance[i] * (starts.etendue[i] * starts.filter_weight[i]);
        buffer.origin.x[at] = rays_.origin.x[i];
        buffer.origin.y[at] = rays_.origin.y[i];
        buffer.origin.z[at] = rays_.origin.z[i];
        buffer.direction.x[at] = rays_.direction.x[i];
        buffer.direction.y[at] = rays_.direction.y[i];
        buffer.direction.z[at] = rays_.direction.z[i];
    }
}

void PolynomialCamera::Paths::weigh(CameraPathBuffer& buffer) const {
    buffer.leave_heroes_alone();
    buffer.pdf.assign(buffer.weights.size(), {});
    if (carry_ != PathCarry::wavelengths_and_pdfs) {
        return;
    }
    for (std::size_t path = 0; path < buffer.weights.size(); ++path) {
        const Ray<double> out = buffer.ray(path);
        const FilmImportance film =
            camera_->importance(sensor_, {out.origin, -1.0 * out.direction}, grid_.path(buffer.wavelength[path]));
        buffer.pdf[path] = {.shared = film.shared_pdf(0), .hero = film.pdf[0]};
    }
}

FilmImportance PolynomialCamera::importance(const Sensor& sensor, const Ray<double>& ray,
                                            const spectral::PathWavelengths& path) const {
    FilmImportance found;
    const pupil::PupilMap& map = exact_.pupil().map();
    const double z = polynomial_.frame().film_z - polynomial_.frame().pupil_z;
    for (std::size_t i = 0; i < spectral::kWavelengthsPerPath; ++i) {
        const std::optional<polynomial::PolynomialEnd> end = polynomial_.end(ray, path.index[i]);
        if (!end) {
            continue;
        }
        const double band = static_cast<double>(path.index[i]) / (exact_.lens().wavelengths() - 1);
        const double per_mm2 = map.pdf(end->film, band, end->pupil);
        if (!is_in_region(per_mm2) || !(end->transmittance > 0.0)) {
            continue;
        }
        const Vec2d across = end->pupil - end->film;
        const double distance2 = dot(across, across) + z * z;
        found.at_px[i] = sensor.pixel(end->film);
        found.transmittance[i] = end->transmittance * end->etendue;
        found.pdf[i] = per_mm2 * distance2 * distance2 / (z * z) * end->etendue;
    }
    return found;
}

}  // namespace lensproof::render
