#include "engine/render/shared_rays.h"

#include <algorithm>
#include <cmath>

namespace lensproof {

const std::vector<std::array<float, kWavelengthsPerPath>>& SharedRays::weigh(const CameraPathBuffer<double>& paths) {
    weights_.resize(static_cast<std::size_t>(paths.size));
    for (int first = 0; first < paths.size; first += kBlock) {
        const int count = std::min(kBlock, paths.size - first);
        trace(paths, first, count);
        for (int i = 0; i < count; ++i) {
            const auto path = static_cast<std::size_t>(first) + static_cast<std::size_t>(i);
            const PathWavelengths strata = grid_.path(paths.wavelength[path]);
            std::array<double, kWavelengthsPerPath> transmittance{};
            double density = 0.0;
            for (std::size_t m = 0; m < kWavelengthsPerPath; ++m) {
                const std::size_t ray = static_cast<std::size_t>(i) * kWavelengthsPerPath + m;
                if (rays_.status[ray] != RayStatus::ok) {
                    continue;
                }
                Vec2d film{paths.film_x[path], paths.film_y[path]};
                const double own = etendue_density(ray, strata.index[m], film);
                const Vec2d pixel = sensor_.pixel(film);
                const auto width = static_cast<std::uint32_t>(sensor_.width);
                const std::uint32_t row = paths.pixel[path] / width;
                const double across = pixel.x - paths.pixel[path] % width;
                const double down = pixel.y - row;
                // The hero's point lies in the pixel, wherever rounding may see it.
                if (m == 0 || (across >= -0.5 && across < 0.5 && down >= -0.5 && down < 0.5)) {
                    transmittance[m] = rays_.transmittance[ray];
                    density += own / kWavelengthsPerPath;
                }
            }
            for (std::size_t m = 0; m < kWavelengthsPerPath; ++m) {
                weights_[path][m] = density > 0.0 ? static_cast<float>(transmittance[m] / density) : 0.0F;
            }
        }
    }
    return weights_;
}

/// From the ray outside forward through the lens, at each wavelength.
void SharedRays::trace(const CameraPathBuffer<double>& paths, int first, int count) {
    rays_.size = count * kWavelengthsPerPath;
    for (int i = 0; i < count; ++i) {
        const Ray<double> out = paths.ray(first + i);
        const Ray<double> in{out.origin, -1.0 * out.direction};
        const auto path = static_cast<std::size_t>(first) + static_cast<std::size_t>(i);
        const PathWavelengths strata = grid_.path(paths.wavelength[path]);
        for (int m = 0; m < kWavelengthsPerPath; ++m) {
            const int ray = i * kWavelengthsPerPath + m;
            rays_.set(ray, in);
            rays_.wavelength[static_cast<std::size_t>(ray)] = strata.index[static_cast<std::size_t>(m)];
        }
    }
    trace_batch<Direction::forward>(*lens_, rays_, {.carry = Carry::transmittance});
}

/// The density per etendue, 1/(mm² sr) times a pixel's area, with which the wavelength as hero would draw this ray; and
/// its film point.
double SharedRays::etendue_density(std::size_t ray, int wavelength, Vec2d& film) const {
    const Ray<double> behind = rays_.ray(static_cast<int>(ray));
    const auto crossing = [&](double z) {
        const double along = (z - behind.origin.z) / behind.direction.z;
        return Vec2d{behind.origin.x + along * behind.direction.x, behind.origin.y + along * behind.direction.y};
    };
    const double film_z = lens_->at(0).image_z;
    const double pupil_z = pupil_->map().plane_z();
    film = crossing(film_z);
    const double band = static_cast<double>(wavelength) / (lens_->wavelengths() - 1);
    const double density = pupil_->map().density(film, band, crossing(pupil_z));
    const double way = (film_z - pupil_z) / behind.direction.z;
    return density * way * way / (behind.direction.z * behind.direction.z);
}

}  // namespace lensproof
