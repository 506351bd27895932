#include "engine/render/camera_paths.h"

#include <algorithm>
#include <functional>
#include <stdexcept>

#include "engine/render/film_points.h"

namespace lensproof::render {

namespace {

void draw_one_pupil_point(const pupil::PupilSlices& pupil, PathStarts& starts, std::size_t i) {
    const pupil::PupilDraw<double> draw =
        pupil.sample({starts.film_x[i], starts.film_y[i]}, starts.wavelength[i], starts.pupil_u[i], starts.pupil_v[i]);
    starts.pupil_x[i] = draw.point.x;
    starts.pupil_y[i] = draw.point.y;
    starts.pupil_area[i] = draw.area;
}

/// Which paths of a chunk left the lens, in their order.
struct Survivors {
    std::array<std::uint16_t, kPathChunk> path;
    int count = 0;

    /// Writes what a column has of them to `to`, one after the other.
    template <class Number>
    void copy(const Number* column, Number* to) const {
        for (int k = 0; k < count; ++k) {
            to[k] = column[path[static_cast<std::size_t>(k)]];
        }
    }
};

template <class T>
Survivors find_survivors(const PathStarts& starts, const optics::RayBatch<T>& rays) {
    Survivors survivors;
    for (std::size_t i = 0; i < static_cast<std::size_t>(rays.size); ++i) {
        survivors.path[static_cast<std::size_t>(survivors.count)] = static_cast<std::uint16_t>(i);
        survivors.count += rays.status[i] == optics::RayStatus::ok && starts.pupil_area[i] > 0.0 ? 1 : 0;
    }
    return survivors;
}

}  // namespace

template <class T>
CameraPathBuffer<T>::CameraPathBuffer(int most) : capacity(most) {
    if (most < 1) {
        throw std::invalid_argument("a buffer of camera paths holds one at least");
    }
    const auto resize = [most](auto&... columns) { (columns.resize(static_cast<std::size_t>(most)), ...); };
    resize(pixel, sample, wavelength, film_x, film_y, weight);
    resize(origin.x, origin.y, origin.z, direction.x, direction.y, direction.z);
}

template <class T>
CameraPathProducer<T>::CameraPathProducer(const CameraPathSource<T>& source, std::optional<optics::SimdLevel> level)
    : source_(source),
      tracing_{.carry = optics::Carry::transmittance, .level = level},
      kernels_(&path_kernels<T>(level)),
      starts_(std::make_unique<PathStarts>()),
      rays_(kPathChunk) {}

template <class T>
void CameraPathProducer<T>::start(const CameraPathRange& range) {
    cursor_ = {.pixel = range.first_pixel, .sample = 0, .first_sample = range.first_sample, .samples = range.samples};
    end_pixel_ = range.first_pixel + (range.samples > 0 ? range.pixels : 0);
}

template <class T>
bool CameraPathProducer<T>::fill(CameraPathBuffer<T>& buffer) {
    buffer.size = 0;
    while (cursor_.pixel < end_pixel_) {
        // As many as surely fit, in whole packets while there are such.
        const int room = buffer.capacity - buffer.size;
        if (room < optics::kMostLanes && buffer.size > 0) {
            break;
        }
        const int whole = room < optics::kMostLanes ? room : room / optics::kMostLanes * optics::kMostLanes;
        const std::uint64_t left = std::uint64_t{end_pixel_ - cursor_.pixel} * cursor_.samples - cursor_.sample;
        if (draw_and_trace(static_cast<int>(std::min<std::uint64_t>(left, std::min(whole, kPathChunk))))) {
            move_survivors(buffer);
        }
    }
    return buffer.size > 0;
}

template <class T>
bool CameraPathProducer<T>::draw_and_trace(int count) {
    kernels_->draw_samples({.sensor = source_.sensor, .seed = source_.seed, .wavelengths = source_.lens->wavelengths()},
                           count, cursor_, *starts_);
    draw_from_filter(source_.filter, source_.sensor, *starts_, filter_weight_);
    if (draw_pupil_points() == 0) {
        return false;
    }
    kernels_->aim_rays(source_.lens->at(0).image_z, source_.pupil->map().plane_z(), *starts_, rays_);
    weigh_by_filter();
    optics::trace_batch<optics::Direction::reverse>(*source_.lens, rays_, tracing_);
    return true;
}

template <class T>
void CameraPathProducer<T>::weigh_by_filter() {
    if (!source_.filter.is_box()) {
        std::transform(starts_->etendue.begin(), starts_->etendue.begin() + starts_->size, filter_weight_.begin(),
                       starts_->etendue.begin(), std::multiplies<>());
    }
}

template <class T>
int CameraPathProducer<T>::draw_pupil_points() {
    const pupil::PupilSliceTables* tables = source_.pupil->tables();
    if (tables != nullptr) {
        kernels_->draw_pupil_points(*tables, *starts_);
    }
    int lit = 0;
    for (std::size_t i = 0; i < static_cast<std::size_t>(starts_->size); ++i) {
        if (tables == nullptr || starts_->pupil_area[i] < 0.0) {
            draw_one_pupil_point(*source_.pupil, *starts_, i);
        }
        lit += starts_->pupil_area[i] > 0.0 ? 1 : 0;
    }
    started_ += lit;
    return lit;
}

template <class T>
void CameraPathProducer<T>::move_survivors(CameraPathBuffer<T>& buffer) {
    for (std::size_t i = 0; i < static_cast<std::size_t>(rays_.size); ++i) {
        rays_.transmittance[i] *= static_cast<T>(starts_->etendue[i]);
    }
    const Survivors survivors = find_survivors(*starts_, rays_);
    const auto append = [&](const auto& from, auto& to) { survivors.copy(from.data(), to.data() + buffer.size); };
    append(starts_->pixel, buffer.pixel);
    append(starts_->sample, buffer.sample);
    append(starts_->wavelength, buffer.wavelength);
    append(starts_->film_x, buffer.film_x);
    append(starts_->film_y, buffer.film_y);
    append(rays_.transmittance, buffer.weight);
    append(rays_.origin.x, buffer.origin.x);
    append(rays_.origin.y, buffer.origin.y);
    append(rays_.origin.z, buffer.origin.z);
    append(rays_.direction.x, buffer.direction.x);
    append(rays_.direction.y, buffer.direction.y);
    append(rays_.direction.z, buffer.direction.z);
    buffer.size += survivors.count;
}

template struct CameraPathBuffer<float>;
template struct CameraPathBuffer<double>;
template class CameraPathProducer<float>;
template class CameraPathProducer<double>;

}  // namespace lensproof::render
