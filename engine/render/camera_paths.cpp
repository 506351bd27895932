#include "engine/render/camera_paths.h"

#include <algorithm>
#include <stdexcept>

namespace lensproof {

namespace {

/// Points of the pupil for film points, one at a time. Returns how many have a density.
int draw_pupil_points(const PupilMap& pupil, int wavelengths, PathStarts& starts) {
    const double last = wavelengths > 1 ? wavelengths - 1.0 : 1.0;
    int lit = 0;
    for (std::size_t i = 0; i < static_cast<std::size_t>(starts.size); ++i) {
        const PupilSample sample = pupil.sample({starts.film_x[i], starts.film_y[i]}, starts.wavelength[i] / last,
                                                starts.pupil_u[i], starts.pupil_v[i]);
        starts.pupil_x[i] = sample.point.x;
        starts.pupil_y[i] = sample.point.y;
        starts.pupil_density[i] = sample.density;
        lit += sample.density > 0.0 ? 1 : 0;
    }
    return lit;
}

/// Writes those of `from` that `kept` names to the end of a buffer's column.
template <class To, class From>
void append(To& to, int at, const From& from, const std::array<std::uint16_t, kPathChunk>& kept, int count) {
    auto* end = to.data() + at;
    const auto* column = from.data();
    for (int k = 0; k < count; ++k) {
        end[k] = column[kept[static_cast<std::size_t>(k)]];
    }
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
    const int wavelengths = source_.lens->wavelengths();
    kernels_->draw({.sensor = source_.sensor, .seed = source_.seed, .wavelengths = wavelengths}, count, cursor_,
                   *starts_);
    const int lit = draw_pupil_points(*source_.pupil, wavelengths, *starts_);
    started_ += lit;
    if (lit == 0) {
        return false;
    }
    kernels_->aim(source_.lens->at(0).image_z, source_.pupil->plane_z(), *starts_, rays_);
    trace_batch<Direction::reverse>(*source_.lens, rays_, tracing_);
    return true;
}

template <class T>
void CameraPathProducer<T>::move_survivors(CameraPathBuffer<T>& buffer) const {
    std::array<std::uint16_t, kPathChunk> kept;
    int count = 0;
    for (int i = 0; i < rays_.size; ++i) {
        const auto at = static_cast<std::size_t>(i);
        kept[static_cast<std::size_t>(count)] = static_cast<std::uint16_t>(i);
        count += rays_.status[at] == RayStatus::ok && starts_->pupil_density[at] > 0.0 ? 1 : 0;
    }
    const int at = buffer.size;
    append(buffer.pixel, at, starts_->pixel, kept, count);
    append(buffer.sample, at, starts_->sample, kept, count);
    append(buffer.wavelength, at, rays_.wavelength, kept, count);
    append(buffer.film_x, at, starts_->film_x, kept, count);
    append(buffer.film_y, at, starts_->film_y, kept, count);
    append(buffer.origin.x, at, rays_.origin.x, kept, count);
    append(buffer.origin.y, at, rays_.origin.y, kept, count);
    append(buffer.origin.z, at, rays_.origin.z, kept, count);
    append(buffer.direction.x, at, rays_.direction.x, kept, count);
    append(buffer.direction.y, at, rays_.direction.y, kept, count);
    append(buffer.direction.z, at, rays_.direction.z, kept, count);
    for (int k = 0; k < count; ++k) {
        const auto i = static_cast<std::size_t>(kept[static_cast<std::size_t>(k)]);
        buffer.weight[static_cast<std::size_t>(at + k)] = rays_.transmittance[i] * static_cast<T>(starts_->etendue[i]);
    }
    buffer.size += count;
}

template struct CameraPathBuffer<float>;
template struct CameraPathBuffer<double>;
template class CameraPathProducer<float>;
template class CameraPathProducer<double>;

}  // namespace lensproof
