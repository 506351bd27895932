#include "engine/render/camera/shared_rays.h"

#include <algorithm>

#include "engine/optics/convert_lens.h"

namespace lensproof::render {

FilmMeeting meet_film(const pupil::PupilMap& pupil, double film_z, double band_position, const Ray<double>& behind) {
    const auto crossing = [&](double z) {
        const double along = (z - behind.origin.z) / behind.direction.z;
        return Vec2d{behind.origin.x + along * behind.direction.x, behind.origin.y + along * behind.direction.y};
    };
    const Vec2d film = crossing(film_z);
    const double per_mm2 = pupil.pdf(film, band_position, crossing(pupil.plane_z()));
    const double distance = (film_z - pupil.plane_z()) / behind.direction.z;
    return {.point = film, .pdf = per_mm2 * distance * distance / (behind.direction.z * behind.direction.z)};
}

template <class T>
void BasicSharedRays<T>::weigh(CameraPathBuffer& paths) {
    paths.weights.resize(static_cast<std::size_t>(paths.size));
    paths.pdf.resize(paths.weights.size());
    for (int first = 0; first < paths.size; first += kBlock) {
        const int count = std::min(kBlock, paths.size - first);
        trace(paths, first, count);
        for (int i = 0; i < count; ++i) {
            const auto path = static_cast<std::size_t>(first) + static_cast<std::size_t>(i);
            const spectral::PathWavelengths strata = grid_.path(paths.wavelength[path]);
            FilmImportance film;
            for (std::size_t m = 0; m < spectral::kWavelengthsPerPath; ++m) {
                const std::size_t ray = static_cast<std::size_t>(i) * spectral::kWavelengthsPerPath + m;
                if (rays_.status[ray] != optics::RayStatus::ok) {
                    continue;
                }
                const double band = static_cast<double>(strata.index[m]) / (lens_->wavelengths() - 1);
                const FilmMeeting meeting = meet_film(pupil_->map(), lens_->at(0).image_z, band,
                                                      optics::convert_ray<double>(rays_.ray(static_cast<int>(ray))));
                film.at_px[m] = sensor_.pixel(meeting.point);
                film.transmittance[m] = rays_.transmittance[ray];
                film.pdf[m] = meeting.pdf;
            }
            paths.weights[path] = shared_weights(film, path_pixel(paths, path, sensor_, is_box_), paths.pdf[path]);
        }
    }
}

/// From the ray outside forward through the lens, at each wavelength.
template <class T>
void BasicSharedRays<T>::trace(const CameraPathBuffer& paths, int first, int count) {
    rays_.size = count * spectral::kWavelengthsPerPath;
    for (int i = 0; i < count; ++i) {
        const auto path = static_cast<std::size_t>(first) + static_cast<std::size_t>(i);
        const Ray<double> out = paths.ray(path);
        const Ray<double> in{out.origin, -1.0 * out.direction};
        const spectral::PathWavelengths strata = grid_.path(paths.wavelength[path]);
        for (int m = 0; m < spectral::kWavelengthsPerPath; ++m) {
            const int ray = i * spectral::kWavelengthsPerPath + m;
            rays_.set(ray, optics::convert_ray<T>(in));
            rays_.wavelength[static_cast<std::size_t>(ray)] = strata.index[static_cast<std::size_t>(m)];
        }
    }
    optics::trace_batch<optics::Direction::forward>(*lens_, rays_, {.carry = optics::Carry::transmittance});
}

template class BasicSharedRays<float>;
template class BasicSharedRays<double>;

}  // namespace lensproof::render
