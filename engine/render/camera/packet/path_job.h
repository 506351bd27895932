// engine/render/camera/packet/path_job.h — camera paths from their sample to the exit ray, an item a path.
#pragma once
#include <cstdint>

#include "engine/optics/device/lens_view.h"
#include "engine/pupil/pupil_slice.h"
#include "engine/render/camera/packet/aim.h"
#include "engine/render/camera/packet/path_chunk.h"
#include "engine/render/sampling/sampler.h"

namespace lensproof::render {

/// What becomes of a sample.
enum class PathFate : std::uint8_t {
    unlit,    // no light reaches its film point: no path is started
    stopped,  // by the lens
    leaves,
};

/// A path each; those that do not leave have a fate and nothing else.
struct DevicePathColumns {
    PathFate* fate = nullptr;
    std::uint16_t* wavelength = nullptr;
    double* film_x = nullptr;  // null, with film_y and etendue: not asked for
    double* film_y = nullptr;
    double* etendue = nullptr;
    double* weight = nullptr;
    double* x = nullptr;
    double* y = nullptr;
    double* z = nullptr;
    double* dx = nullptr;
    double* dy = nullptr;
    double* dz = nullptr;
};

/// The samples of a range from `first` on, drawn from the pixels themselves (the box filter). Every path has the bits
/// of BasicLensPaths, which does the same in loops over packets.
template <class T, optics::LensMakeup makeup>
struct PathJob {
    static constexpr int kThreadsPerBlock = 128;

    optics::LensView<T> lens;
    pupil::PupilSliceTables pupil;
    double pupil_z = 0.0;
    double film_z = 0.0;
    const sampler_detail::DigitPoints* sobol_points = nullptr;
    Sensor sensor;
    std::uint64_t seed = 0;
    CameraPathRange range;
    std::uint64_t first = 0;
    DevicePathColumns paths;

    constexpr void operator()(int item) const {
        const CameraPathRange::Place place = range.place(first + static_cast<std::uint64_t>(item));
        const auto numbers = PixelSampler(seed, place.pixel).point(range.first_sample + place.sample, *sobol_points);
        const auto width = static_cast<std::uint32_t>(sensor.width);
        const std::uint32_t row = place.pixel / width;
        const std::uint32_t column = place.pixel - row * width;
        const Vec2d film{sensor.position(static_cast<double>(column) - 0.5 + numbers[0], 0.0).x,
                         sensor.position(0.0, static_cast<double>(row) - 0.5 + numbers[1]).y};
        const auto wavelength = static_cast<std::uint16_t>(static_cast<int>(numbers[4] * lens.wavelengths));
        const pupil::PupilDraw<double> drawn =
            pupil::draw_pupil_point(pupil, static_cast<double>(wavelength), film, numbers[2], numbers[3]);
        if (!(drawn.area > 0.0)) {
            paths.fate[item] = PathFate::unlit;
            return;
        }
        const AimedRay<double> aimed = aim(film, drawn.point, pupil_z - film_z, drawn.area);
        trace(item, wavelength, film, aimed);
    }

  private:
    constexpr void trace(int item, std::uint16_t wavelength, const Vec2d& film, const AimedRay<double>& aimed) const {
        const Ray<T> ray{
            {static_cast<T>(film.x), static_cast<T>(film.y), static_cast<T>(film_z)},
            {static_cast<T>(aimed.direction.x), static_cast<T>(aimed.direction.y), static_cast<T>(aimed.direction.z)}};
        const auto at = lens.at(wavelength);
        const auto traced = optics::trace_through<optics::Direction::reverse, optics::Rims::clip, makeup>(
            at, ray, [](const optics::SurfaceEvent<T>&) {});
        if (traced.status != optics::RayStatus::ok) {
            paths.fate[item] = PathFate::stopped;
            return;
        }
        Vec3d direction{traced.ray.direction.x, traced.ray.direction.y, traced.ray.direction.z};
        if constexpr (!std::is_same_v<T, double>) {
            direction = normalized(direction);
        }
        paths.fate[item] = PathFate::leaves;
        paths.wavelength[item] = wavelength;
        if (paths.film_x != nullptr) {
            paths.film_x[item] = film.x;
            paths.film_y[item] = film.y;
            paths.etendue[item] = aimed.etendue;
        }
        paths.weight[item] = aimed.etendue * static_cast<double>(traced.transmittance);
        paths.x[item] = traced.ray.origin.x;
        paths.y[item] = traced.ray.origin.y;
        paths.z[item] = traced.ray.origin.z;
        paths.dx[item] = direction.x;
        paths.dy[item] = direction.y;
        paths.dz[item] = direction.z;
    }
};

}  // namespace lensproof::render
