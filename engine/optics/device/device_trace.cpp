#include "engine/optics/device/device_trace.h"

#include <algorithm>
#include <array>

#include "engine/optics/device/trace_job.h"

namespace lensproof::optics {

namespace {

constexpr std::size_t kPiece = std::size_t{1} << 18U;  // rays: enough to fill a GPU, few enough to overlap

/// A piece's columns here and on the device, and the queue that it goes through.
template <class T>
class Piece {
  public:
    Piece(const Device& device, std::size_t most)
        : queue_(device),
          numbers_here_(device, kNumbers * most),
          numbers_there_(device, kNumbers * most),
          wavelengths_here_(device, most),
          wavelengths_there_(device, most),
          statuses_here_(device, most),
          statuses_there_(device, most),
          surfaces_here_(device, most),
          surfaces_there_(device, most),
          most_(most) {}

    /// Starts rays `first` … of `rays`, as many as fit.
    template <Direction direction>
    void start(const DeviceLens<T>& lens, const RayColumns<T>& rays, std::size_t first, const BatchSettings& settings) {
        first_ = first;
        count_ = std::min(most_, static_cast<std::size_t>(rays.size) - first);
        const std::array<T*, 6> given = {rays.x, rays.y, rays.z, rays.dx, rays.dy, rays.dz};
        for (std::size_t i = 0; i < given.size(); ++i) {
            std::copy_n(given[i] + first, count_, numbers_here_.data() + i * most_);
        }
        if (rays.wavelength != nullptr) {
            std::copy_n(rays.wavelength + first, count_, wavelengths_here_.data());
            queue_.upload(wavelengths_there_.data(), wavelengths_here_.data(), count_ * sizeof(std::uint16_t));
        }
        for (std::size_t i = 0; i < given.size(); ++i) {
            queue_.upload(numbers_there_.data() + i * most_, numbers_here_.data() + i * most_, count_ * sizeof(T));
        }
        with_trace_job<direction>(lens.view(), there(), settings.rims, settings.carry,
                                  [&](const auto& job) { queue_.run(job, static_cast<int>(count_)); });
        queue_.download(numbers_here_.data(), numbers_there_.data(), numbers_here_.bytes());
        queue_.download(statuses_here_.data(), statuses_there_.data(), count_ * sizeof(RayStatus));
        queue_.download(surfaces_here_.data(), surfaces_there_.data(), count_ * sizeof(std::int16_t));
    }

    /// Waits for what was started, if anything, and puts it into `rays`.
    void finish(const RayColumns<T>& rays, Carry carry) {
        if (count_ == 0) {
            return;
        }
        queue_.wait();
        const std::array<T*, kNumbers> found = {rays.x,
                                                rays.y,
                                                rays.z,
                                                rays.dx,
                                                rays.dy,
                                                rays.dz,
                                                carry != Carry::geometry ? rays.transmittance : nullptr,
                                                carry == Carry::all ? rays.optical_path : nullptr};
        for (std::size_t i = 0; i < found.size(); ++i) {
            if (found[i] != nullptr) {
                std::copy_n(numbers_here_.data() + i * most_, count_, found[i] + first_);
            }
        }
        std::copy_n(statuses_here_.data(), count_, rays.status + first_);
        std::copy_n(surfaces_here_.data(), count_, rays.surface + first_);
        count_ = 0;
    }

  private:
    static constexpr std::size_t kNumbers = 8;

    [[nodiscard]] RayColumns<T> there() const {
        const auto column = [&](std::size_t i) { return numbers_there_.data() + i * most_; };
        return {.x = column(0),
                .y = column(1),
                .z = column(2),
                .dx = column(3),
                .dy = column(4),
                .dz = column(5),
                .optical_path = column(7),
                .transmittance = column(6),
                .wavelength = wavelengths_there_.data(),
                .status = statuses_there_.data(),
                .surface = surfaces_there_.data(),
                .size = static_cast<int>(count_)};
    }

    Device::Queue queue_;
    PinnedArray<T> numbers_here_;
    DeviceArray<T> numbers_there_;
    PinnedArray<std::uint16_t> wavelengths_here_;
    DeviceArray<std::uint16_t> wavelengths_there_;
    PinnedArray<RayStatus> statuses_here_;
    DeviceArray<RayStatus> statuses_there_;
    PinnedArray<std::int16_t> surfaces_here_;
    DeviceArray<std::int16_t> surfaces_there_;
    std::size_t most_;
    std::size_t first_ = 0;
    std::size_t count_ = 0;
};

}  // namespace

template <Direction direction, class T>
void trace_columns_on(const Device& device, const DeviceLens<T>& lens, const RayColumns<T>& rays,
                      const BatchSettings& settings) {
    const auto size = static_cast<std::size_t>(rays.size);
    const std::size_t most = std::min(size, kPiece);
    std::array<Piece<T>, 2> pieces = {Piece<T>(device, most), Piece<T>(device, most)};
    std::size_t next = 0;
    for (std::size_t first = 0; first < size; first += most) {
        pieces[next].finish(rays, settings.carry);
        pieces[next].template start<direction>(lens, rays, first, settings);
        next = 1 - next;
    }
    pieces[next].finish(rays, settings.carry);
    pieces[1 - next].finish(rays, settings.carry);
}

template void trace_columns_on<Direction::forward>(const Device&, const DeviceLens<float>&, const RayColumns<float>&,
                                                   const BatchSettings&);
template void trace_columns_on<Direction::reverse>(const Device&, const DeviceLens<float>&, const RayColumns<float>&,
                                                   const BatchSettings&);
template void trace_columns_on<Direction::forward>(const Device&, const DeviceLens<double>&, const RayColumns<double>&,
                                                   const BatchSettings&);
template void trace_columns_on<Direction::reverse>(const Device&, const DeviceLens<double>&, const RayColumns<double>&,
                                                   const BatchSettings&);

template <class T>
DeviceEvents<T>::DeviceEvents(const Device& device, const DeviceLens<T>& lens, std::span<const Ray<T>> rays,
                              std::span<const std::uint16_t> wavelengths, const EventWay& way)
    // A ghost of n reflections crosses the lens n + 1 times, and meets the sensor at most n times.
    : most_events_((way.reflections.size() + 1) * static_cast<std::size_t>(lens.view().surface_count) +
                   way.reflections.size()),
      events_(device, rays.size() * most_events_),
      counts_(device, rays.size()),
      ends_(device, rays.size()) {
    Device::Queue queue(device);
    const auto sent = [&]<class Item>(std::span<const Item> items) {
        DeviceArray<Item> there(device, items.size());
        queue.upload(there.data(), items.data(), items.size_bytes());
        return there;
    };
    const DeviceArray<Ray<T>> rays_there = sent(rays);
    const DeviceArray<std::uint16_t> wavelengths_there = sent(wavelengths);
    const DeviceArray<int> reflections_there = sent(std::span<const int>(way.reflections));
    const DeviceArray<SurfaceEvent<T>> events_there(device, events_.size());
    const DeviceArray<std::int32_t> counts_there(device, counts_.size());
    const DeviceArray<TracedRay<T>> ends_there(device, ends_.size());
    queue.run(EventJob<T>{.lens = lens.view(),
                          .rays = rays_there.data(),
                          .wavelength = wavelengths_there.data(),
                          .events = events_there.data(),
                          .event_counts = counts_there.data(),
                          .ends = ends_there.data(),
                          .most_events = static_cast<int>(most_events_),
                          .direction = way.direction,
                          .rims = way.rims,
                          .reflections = {reflections_there.data(), way.reflections.size()},
                          .mirrors = {static_cast<T>(way.mirrors.sensor), static_cast<T>(way.mirrors.blades)}},
              static_cast<int>(rays.size()));
    queue.download(events_.data(), events_there.data(), events_.bytes());
    queue.download(counts_.data(), counts_there.data(), counts_.bytes());
    queue.download(ends_.data(), ends_there.data(), ends_.bytes());
    queue.wait();
}

template class DeviceEvents<float>;
template class DeviceEvents<double>;

}  // namespace lensproof::optics
