#include "engine/render/camera_paths.h"

#include <algorithm>
#include <functional>
#include <stdexcept>

namespace lensproof {

namespace {

void draw_one_pupil_point(const PupilSlices& pupil, PathStarts& starts, std::size_t i) {
    const PupilDraw<double> draw =
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
Survivors find_survivors(const PathStarts& starts, const RayBatch<T>& rays) {
    Survivors survivors;
    for (std::size_t i = 0; i < static_cast<std::size_t>(rays.size); ++i) {
        survivors.path[static_cast<std::size_t>(survivors.count)] = static_cast<std::uint16_t>(i);
        survivors.count += rays.status[i] == RayStatus::ok && starts.pupil_area[i] > 0.0 ? 1 : 0;
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
CameraPathProducer<T>::CameraPathProducer(const CameraPathSource<T>& source, std::optional<SimdLevel> level)
    : source_(source),
      tracing_{.carry = Carry::transmittance, .level = level},
      kernels_(&path_kernels<T>(level.value_or(available_simd_levels().back()))),
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
        if (room < kMostLanes && buffer.size > 0) {
            break;
        }
        const int whole = room < kMostLanes ? room : room / kMostLanes * kMostLanes;
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
    draw_from_filter();
    if (draw_pupil_points() == 0) {
        return false;
    }
    kernels_->aim_rays(source_.lens->at(0).image_z, source_.pupil->map().plane_z(), *starts_, rays_);
    weigh_by_filter();
    trace_batch<Direction::reverse>(*source_.lens, rays_, tracing_);
    return true;
}

/// Film points are even over their pixel so far; where in it makes the number that the filter's draw takes.
template <class T>
void CameraPathProducer<T>::draw_from_filter() {
    if (source_.filter.is_box()) {
        return;
    }
    const Sensor& sensor = source_.sensor;
    const auto width = static_cast<std::uint32_t>(sensor.width);
    for (std::size_t i = 0; i < static_cast<std::size_t>(starts_->size); ++i) {
        const std::uint32_t row_number = starts_->pixel[i] / width;
        const double row = row_number;
        const double column = starts_->pixel[i] - row_number * width;
        const Vec2d centre = sensor.position(column, row);
        const PixelFilter::Draw across =
            source_.filter.draw((centre.x - starts_->film_x[i]) / sensor.pixel_pitch_mm + 0.5);
        const PixelFilter::Draw down =
            source_.filter.draw((starts_->film_y[i] - centre.y) / sensor.pixel_pitch_mm + 0.5);
        const Vec2d drawn = sensor.position(column + across.offset_px, row + down.offset_px);
        starts_->film_x[i] = drawn.x;
        starts_->film_y[i] = drawn.y;
        filter_weight_[i] = across.weight * down.weight;
    }
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
    const PupilSliceTables* tables = source_.pupil->tables();
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

}  // namespace lensproof
