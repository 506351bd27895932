#include "engine/render/camera/shared_rays.h"

#include <algorithm>
#include <cmath>

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

void SharedRays::weigh(CameraPathBuffer& paths) {
    paths.weights.resize(static_cast<std::size_t>(paths.size));
    paths.pdf.resize(paths.weights.size());
    for (int first = 0; first < paths.size; first += kBlock) {
        const int count = std::min(kBlock, paths.size - first);
        trace(paths, first, count);
        for (int i = 0; i < count; ++i) {
            const auto path = static_cast<std::size_t>(first) + static_cast<std::size_t>(i);
            const spectral::PathWavelengths strata = grid_.path(paths.wavelength[path]);
            const Vec2d centre = pixel_of(paths, path);
            std::array<double, spectral::kWavelengthsPerPath> transmittance{};
            PathPdf& pdf = paths.pdf[path] = {};
            for (std::size_t m = 0; m < spectral::kWavelengthsPerPath; ++m) {
                const std::size_t ray = static_cast<std::size_t>(i) * spectral::kWavelengthsPerPath + m;
                if (rays_.status[ray] != optics::RayStatus::ok) {
                    continue;
                }
                const double band = static_cast<double>(strata.index[m]) / (lens_->wavelengths() - 1);
                const FilmMeeting film =
                    meet_film(pupil_->map(), lens_->at(0).image_z, band, rays_.ray(static_cast<int>(ray)));
                const Vec2d pixel = sensor_.pixel(film.point);
                const double across = pixel.x - centre.x;
                const double down = pixel.y - centre.y;
                // The hero's point lies in the pixel, wherever rounding may see it.
                if (m == 0 || (across >= -0.5 && across < 0.5 && down >= -0.5 && down < 0.5)) {
                    transmittance[m] = rays_.transmittance[ray];
                    pdf.shared += film.pdf / spectral::kWavelengthsPerPath;
                    pdf.hero = m == 0 ? film.pdf : pdf.hero;
                }
            }
            for (std::size_t m = 0; m < spectral::kWavelengthsPerPath; ++m) {
                paths.weights[path][m] = pdf.shared > 0.0 ? static_cast<float>(transmittance[m] / pdf.shared) : 0.0F;
            }
        }
    }
}

/// The centre of the pixel that the path belongs to.
Vec2d SharedRays::pixel_of(const CameraPathBuffer& paths, std::size_t path) const {
    if (is_box_) {
        const auto width = static_cast<std::uint32_t>(sensor_.width);
        const std::uint32_t row = paths.pixel[path] / width;
        return {static_cast<double>(paths.pixel[path] % width), static_cast<double>(row)};
    }
    const Vec2d at = sensor_.pixel({paths.film_x[path], paths.film_y[path]});
    return {std::floor(at.x + 0.5), std::floor(at.y + 0.5)};
}

/// From the ray outside forward through the lens, at each wavelength.
void SharedRays::trace(const CameraPathBuffer& paths, int first, int count) {
    rays_.size = count * spectral::kWavelengthsPerPath;
    for (int i = 0; i < count; ++i) {
        const auto path = static_cast<std::size_t>(first) + static_cast<std::size_t>(i);
        const Ray<double> out = paths.ray(path);
        const Ray<double> in{out.origin, -1.0 * out.direction};
        const spectral::PathWavelengths strata = grid_.path(paths.wavelength[path]);
        for (int m = 0; m < spectral::kWavelengthsPerPath; ++m) {
            const int ray = i * spectral::kWavelengthsPerPath + m;
            rays_.set(ray, in);
            rays_.wavelength[static_cast<std::size_t>(ray)] = strata.index[static_cast<std::size_t>(m)];
        }
    }
    optics::trace_batch<optics::Direction::forward>(*lens_, rays_, {.carry = optics::Carry::transmittance});
}

}  // namespace lensproof::render
