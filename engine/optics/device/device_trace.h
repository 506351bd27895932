// engine/optics/device/device_trace.h — the tracer on a device, for rays in this machine's memory.
#pragma once
#include <array>
#include <memory>
#include <optional>
#include <span>

#include "engine/device/device_buffer.h"
#include "engine/device/shared_device.h"
#include "engine/optics/device/device_lens.h"
#include "engine/optics/packet/ray_batch.h"
#include "engine/optics/packet/trace_batch.h"
#include "engine/optics/ray_course.h"

namespace lensproof::optics {

/// `trace_columns` by a device, or where there is none, or none that still works, in packets on the processors. Both to
/// the same bits, but for what coatings let pass, which takes sines and exponentials of the machine's own. For one
/// thread.
template <class T>
class ColumnTracer {
  public:
    /// To a GPU go so many rays at a time: enough to fill it, few enough for the next ones to be on their way.
    static constexpr std::size_t kUsualPiece = std::size_t{1} << 18U;

    /// `device`: null will do. Both outlive this. `piece`: a power of two, of 16 or more.
    ColumnTracer(const SpectralLens<T>& lens, device::SharedDevice* device, std::size_t piece = kUsualPiece);
    ColumnTracer(const ColumnTracer&) = delete;
    ColumnTracer& operator=(const ColumnTracer&) = delete;
    ~ColumnTracer();

    /// Whether a device does it: then many rays at a time are better than few.
    [[nodiscard]] bool is_on_device() const { return there_.has_value(); }

    template <Direction direction = Direction::forward>
    void trace(const RayColumns<T>& rays, const BatchSettings& settings = {});

  private:
    class Piece;

    /// Returns how many of them, from the first on, it did: all, or those before the device failed.
    template <Direction direction>
    std::size_t trace_on_device(const RayColumns<T>& rays, const BatchSettings& settings);

    const SpectralLens<T>* lens_;
    device::SharedDevice* device_;
    std::size_t most_;
    std::optional<DeviceLens<T>> there_;            // none: in packets
    std::array<std::unique_ptr<Piece>, 2> pieces_;  // the next one is on its way while one is traced
};

/// What `trace_along` reports of many rays, surface by surface.
template <class T>
class DeviceEvents {
  public:
    /// Of these rays, each at its wavelength of the lens. Throws device::Error.
    DeviceEvents(const device::Device& device, const DeviceLens<T>& lens, std::span<const Ray<T>> rays,
                 std::span<const std::uint16_t> wavelengths, const RayCourse<T>& course);

    /// In their order; and where the ray ended.
    [[nodiscard]] std::span<const SurfaceEvent<T>> events(std::size_t ray) const {
        return {events_.here + ray * most_events_, static_cast<std::size_t>(counts_.here[ray])};
    }
    [[nodiscard]] const TracedRay<T>& end(std::size_t ray) const { return ends_.here[ray]; }

  private:
    std::size_t most_events_;
    device::Buffer buffer_;
    device::Column<SurfaceEvent<T>> events_;
    device::Column<std::int32_t> counts_;
    device::Column<TracedRay<T>> ends_;
};

extern template class ColumnTracer<float>;
extern template class ColumnTracer<double>;
extern template class DeviceEvents<float>;
extern template class DeviceEvents<double>;

}  // namespace lensproof::optics
