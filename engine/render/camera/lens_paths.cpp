#include "engine/render/camera/lens_paths.h"

#include <algorithm>
#include <functional>
#include <type_traits>
#include <utility>

#include "engine/render/camera/survivors.h"

namespace lensproof::render {

namespace {

void draw_one_pupil_point(const pupil::PupilSlices& pupil, PathStarts& starts, std::size_t i) {
    const pupil::PupilDraw<double> draw =
        pupil.sample({starts.film_x[i], starts.film_y[i]}, starts.wavelength[i], starts.pupil_u[i], starts.pupil_v[i]);
    starts.pupil_x[i] = draw.point.x;
    starts.pupil_y[i] = draw.point.y;
    starts.pupil_area[i] = draw.area;
}

/// Rays as aimed, rounded.
void narrow(const optics::RayBatch<double>& from, optics::RayBatch<float>& to) {
    const auto round = [&](const auto& column, auto& rounded) {
        std::transform(column.begin(), column.begin() + from.size, rounded.begin(),
                       [](double number) { return static_cast<float>(number); });
    };
    round(from.origin.x, to.origin.x);
    round(from.origin.y, to.origin.y);
    round(from.origin.z, to.origin.z);
    round(from.direction.x, to.direction.x);
    round(from.direction.y, to.direction.y);
    round(from.direction.z, to.direction.z);
    std::copy_n(from.wavelength.begin(), from.size, to.wavelength.begin());
    to.size = from.size;
}

/// Of paths from `first` on, which float leaves with a length of 1 to its own digits.
void normalize_directions(CameraPathBuffer& buffer, int first) {
    for (auto i = static_cast<std::size_t>(first); i < static_cast<std::size_t>(buffer.size); ++i) {
        const Vec3d unit = normalized(buffer.ray(i).direction);
        buffer.direction.x[i] = unit.x;
        buffer.direction.y[i] = unit.y;
        buffer.direction.z[i] = unit.z;
    }
}

}  // namespace

template <class T>
BasicLensPaths<T>::BasicLensPaths(FilmSampling film, const optics::SpectralLens<T>& lens,
                                  const pupil::PupilSlices& pupil, std::optional<SimdLevel> level)
    : samples_(std::move(film), lens.wavelengths(), level),
      lens_(&lens),
      pupil_(&pupil),
      kernels_(&path_kernels(level)),
      tracing_{.carry = optics::Carry::transmittance, .level = level},
      aimed_(kPathChunk) {
    if constexpr (!std::is_same_v<T, double>) {
        narrowed_.emplace(kPathChunk);
    }
}

template <class T>
bool BasicLensPaths<T>::fill(CameraPathBuffer& buffer) {
    return samples_.fill(buffer, [&](PathStarts& starts) {
        const int lit = draw_pupil_points(starts);
        started_ += lit;
        if (lit == 0) {  // the film gets no light, and nothing is traced
            return;
        }
        kernels_->aim_rays(lens_->at(0).image_z, pupil_->map().plane_z(), starts, aimed_);
        std::transform(starts.etendue.begin(), starts.etendue.begin() + starts.size, starts.filter_weight.begin(),
                       starts.weight.begin(), std::multiplies<>());
        trace();
        move_survivors(starts, buffer);
    });
}

template <class T>
int BasicLensPaths<T>::draw_pupil_points(PathStarts& starts) const {
    const pupil::PupilSliceTables* tables = pupil_->tables();
    if (tables != nullptr) {
        kernels_->draw_pupil_points(*tables, starts);
    }
    int lit = 0;
    for (std::size_t i = 0; i < static_cast<std::size_t>(starts.size); ++i) {
        if (tables == nullptr || starts.pupil_area[i] < 0.0) {
            draw_one_pupil_point(*pupil_, starts, i);
        }
        lit += starts.pupil_area[i] > 0.0 ? 1 : 0;
    }
    return lit;
}

template <class T>
void BasicLensPaths<T>::trace() {
    if constexpr (std::is_same_v<T, double>) {
        optics::trace_batch<optics::Direction::reverse>(*lens_, aimed_, tracing_);
    } else {
        narrow(aimed_, *narrowed_);
        optics::trace_batch<optics::Direction::reverse>(*lens_, *narrowed_, tracing_);
    }
}

template <class T>
void BasicLensPaths<T>::move_survivors(PathStarts& starts, CameraPathBuffer& buffer) {
    const auto move = [&](const auto& rays) {
        for (std::size_t i = 0; i < static_cast<std::size_t>(rays.size); ++i) {
            starts.weight[i] *= rays.transmittance[i];
        }
        const Survivors survivors(rays.size, [&](std::size_t i) {
            return rays.status[i] == optics::RayStatus::ok && starts.pupil_area[i] > 0.0;
        });
        buffer.append(starts, rays, survivors.count, [&](const auto* from, auto* to) { survivors.copy(from, to); });
    };
    const int first = buffer.size;
    if constexpr (std::is_same_v<T, double>) {
        move(aimed_);
    } else {
        move(*narrowed_);
        normalize_directions(buffer, first);
    }
}

template class BasicLensPaths<float>;
template class BasicLensPaths<double>;

}  // namespace lensproof::render
