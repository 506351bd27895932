#include "engine/optics/device/device_trace.h"

#include <algorithm>
#include <bit>
#include <utility>

#include "engine/optics/device/trace_job.h"

namespace lensproof::optics {

/// Some rays, here and on the device.
template <class T>
class ColumnTracer<T>::Piece {
  public:
    Piece(const device::Device& device, std::size_t most)
        : buffer_(device, kNumbers * device::Buffer::bytes_for<T>(most) +
                              device::Buffer::bytes_for<std::uint16_t, RayStatus, std::int16_t>(most)),
          wavelength_(buffer_.column<std::uint16_t>(most)),
          status_(buffer_.column<RayStatus>(most)),
          surface_(buffer_.column<std::int16_t>(most)),
          most_(most) {
        for (device::Column<T>& column : numbers_) {
            column = buffer_.column<T>(most);
        }
    }

    [[nodiscard]] std::size_t most() const { return most_; }

    /// Starts rays `first` … of `rays`, as many as fit.
    template <Direction direction>
    void start(const DeviceLens<T>& lens, const RayColumns<T>& rays, std::size_t first, const BatchSettings& settings) {
        first_ = first;
        count_ = std::min(most_, static_cast<std::size_t>(rays.size) - first);
        const auto send = [&]<class Number>(const Number* from, const device::Column<Number>& to) {
            std::copy_n(from + first_, count_, to.here);
            buffer_.upload(to, count_);
        };
        if (rays.wavelength != nullptr) {
            send(rays.wavelength, wavelength_);
        }
        const std::array<T*, kNumbers> columns = columns_of(rays, Carry::geometry);
        for (std::size_t i = 0; i < kGiven; ++i) {
            send(columns[i], numbers_[i]);
        }
        with_trace_job<direction>(lens.view(), there(), there(), settings.rims, settings.carry,
                                  [&](const auto& job) { buffer_.queue().run(job, static_cast<int>(count_)); });
        for (const device::Column<T>& column : numbers_) {
            buffer_.download(column, count_);
        }
        buffer_.download(status_, count_);
        buffer_.download(surface_, count_);
    }

    /// Waits for what was started, if anything, and puts it into `rays`. Returns how many of them.
    std::size_t finish(const RayColumns<T>& rays, Carry carry) {
        if (count_ == 0) {
            return 0;
        }
        buffer_.queue().wait();
        const std::array<T*, kNumbers> columns = columns_of(rays, carry);
        for (std::size_t i = 0; i < kNumbers; ++i) {
            if (columns[i] != nullptr) {
                std::copy_n(numbers_[i].here, count_, columns[i] + first_);
            }
        }
        std::copy_n(status_.here, count_, rays.status + first_);
        std::copy_n(surface_.here, count_, rays.surface + first_);
        return std::exchange(count_, 0);
    }

  private:
    static constexpr std::size_t kGiven = 6;
    static constexpr std::size_t kNumbers = 8;

    /// Null: not carried.
    static std::array<T*, kNumbers> columns_of(const RayColumns<T>& rays, Carry carry) {
        return {rays.x,
                rays.y,
                rays.z,
                rays.dx,
                rays.dy,
                rays.dz,
                carry != Carry::geometry ? rays.transmittance : nullptr,
                carry == Carry::all ? rays.optical_path : nullptr};
    }

    [[nodiscard]] RayColumns<T> there() const {
        return {.x = numbers_[0].there,
                .y = numbers_[1].there,
                .z = numbers_[2].there,
                .dx = numbers_[3].there,
                .dy = numbers_[4].there,
                .dz = numbers_[5].there,
                .optical_path = numbers_[7].there,
                .transmittance = numbers_[6].there,
                .wavelength = wavelength_.there,
                .status = status_.there,
                .surface = surface_.there,
                .size = static_cast<int>(count_)};
    }

    device::Buffer buffer_;
    std::array<device::Column<T>, kNumbers> numbers_;
    device::Column<std::uint16_t> wavelength_;
    device::Column<RayStatus> status_;
    device::Column<std::int16_t> surface_;
    std::size_t most_;
    std::size_t first_ = 0;
    std::size_t count_ = 0;
};

template <class T>
ColumnTracer<T>::ColumnTracer(const SpectralLens<T>& lens, device::SharedDevice* device, std::size_t piece)
    : lens_(&lens), device_(device), most_(piece) {
    if (device_ == nullptr || device_->has_failed()) {
        return;
    }
    try {
        there_.emplace(device_->device(), lens);
    } catch (const device::Error& error) {
        device_->refuse(error.what());
    }
}

template <class T>
ColumnTracer<T>::~ColumnTracer() = default;

template <class T>
template <Direction direction>
void ColumnTracer<T>::trace(const RayColumns<T>& rays, const BatchSettings& settings) {
    const std::size_t done = there_ ? trace_on_device<direction>(rays, settings) : 0;
    if (done == static_cast<std::size_t>(rays.size)) {
        return;
    }
    RayColumns<T> rest = rays;
    rest.size -= static_cast<int>(done);
    for (T** column :
         {&rest.x, &rest.y, &rest.z, &rest.dx, &rest.dy, &rest.dz, &rest.optical_path, &rest.transmittance}) {
        *column += *column != nullptr ? done : 0;
    }
    rest.wavelength += rest.wavelength != nullptr ? done : 0;
    rest.status += done;
    rest.surface += done;
    trace_columns<direction>(*lens_, rest, settings);
}

template <class T>
template <Direction direction>
std::size_t ColumnTracer<T>::trace_on_device(const RayColumns<T>& rays, const BatchSettings& settings) {
    const auto size = static_cast<std::size_t>(rays.size);
    std::size_t done = 0;
    try {
        const std::size_t most = std::min(std::bit_ceil(size), most_);
        for (std::unique_ptr<Piece>& piece : pieces_) {
            if (!piece || piece->most() < most) {
                piece = std::make_unique<Piece>(device_->device(), most);
            }
        }
        std::size_t next = 0;
        for (std::size_t first = 0; first < size; first += pieces_[next]->most()) {
            done += pieces_[next]->finish(rays, settings.carry);
            pieces_[next]->template start<direction>(*there_, rays, first, settings);
            next = 1 - next;
        }
        done += pieces_[next]->finish(rays, settings.carry);
        done += pieces_[1 - next]->finish(rays, settings.carry);
    } catch (const device::Error& error) {
        there_.reset();
        pieces_ = {};
        device_->fail(error.what());
    }
    return done;
}

template class ColumnTracer<float>;
template class ColumnTracer<double>;
template void ColumnTracer<float>::trace<Direction::forward>(const RayColumns<float>&, const BatchSettings&);
template void ColumnTracer<float>::trace<Direction::reverse>(const RayColumns<float>&, const BatchSettings&);
template void ColumnTracer<double>::trace<Direction::forward>(const RayColumns<double>&, const BatchSettings&);
template void ColumnTracer<double>::trace<Direction::reverse>(const RayColumns<double>&, const BatchSettings&);

template <class T>
DeviceEvents<T>::DeviceEvents(const device::Device& device, const DeviceLens<T>& lens, std::span<const Ray<T>> rays,
                              std::span<const std::uint16_t> wavelengths, const RayCourse<T>& course)
    // A ghost of n reflections crosses the lens n + 1 times, and meets the sensor at most n times.
    : most_events_((course.reflections.size() + 1) * static_cast<std::size_t>(lens.view().surface_count) +
                   course.reflections.size()),
      buffer_(device, device::Buffer::bytes_for<SurfaceEvent<T>>(rays.size() * most_events_) +
                          device::Buffer::bytes_for<Ray<T>, std::uint16_t, std::int32_t, TracedRay<T>>(rays.size()) +
                          device::Buffer::bytes_for<int>(course.reflections.size())),
      events_(buffer_.column<SurfaceEvent<T>>(rays.size() * most_events_)),
      counts_(buffer_.column<std::int32_t>(rays.size())),
      ends_(buffer_.column<TracedRay<T>>(rays.size())) {
    buffer_.queue().run(EventJob<T>{.lens = lens.view(),
                                    .course = {.direction = course.direction,
                                               .rims = course.rims,
                                               .reflections = {buffer_.send(std::span<const int>(course.reflections)),
                                                               course.reflections.size()},
                                               .mirrors = course.mirrors},
                                    .rays = buffer_.send(rays),
                                    .wavelength = buffer_.send(wavelengths),
                                    .events = events_.there,
                                    .event_counts = counts_.there,
                                    .ends = ends_.there,
                                    .most_events = static_cast<int>(most_events_)},
                        static_cast<int>(rays.size()));
    buffer_.download(events_, rays.size() * most_events_);
    buffer_.download(counts_, rays.size());
    buffer_.download(ends_, rays.size());
    buffer_.queue().wait();
}

template class DeviceEvents<float>;
template class DeviceEvents<double>;

}  // namespace lensproof::optics
