// engine/optics/device/device_trace.h — the tracer on a device, for rays in this machine's memory.
#pragma once
#include <span>
#include <vector>

#include "engine/optics/device/device_lens.h"
#include "engine/optics/ghost_path.h"
#include "engine/optics/packet/ray_batch.h"
#include "engine/optics/packet/trace_batch.h"

namespace lensproof::optics {

/// `trace_columns` on the device that the lens lies on, to the same bits but for what coatings let pass, which takes
/// sines and exponentials of the machine's own; `settings.level` is not looked at. In pieces, the next of which is on
/// its way while one is traced. Throws DeviceError.
template <Direction direction = Direction::forward, class T>
void trace_columns_on(const Device& device, const DeviceLens<T>& lens, const RayColumns<T>& rays,
                      const BatchSettings& settings = {});

/// Which way rays take: `trace`, or `trace_ghost` where there are reflections.
struct EventWay {
    Direction direction = Direction::forward;
    Rims rims = Rims::clip;
    GhostPath reflections;
    StrayMirrors<double> mirrors;
};

/// What `trace` reports of many rays, surface by surface.
template <class T>
class DeviceEvents {
  public:
    /// Of these rays, each at its wavelength of the lens. Throws DeviceError.
    DeviceEvents(const Device& device, const DeviceLens<T>& lens, std::span<const Ray<T>> rays,
                 std::span<const std::uint16_t> wavelengths, const EventWay& way);

    /// In their order; and where the ray ended.
    [[nodiscard]] std::span<const SurfaceEvent<T>> events(std::size_t ray) const {
        return {events_.data() + ray * most_events_, static_cast<std::size_t>(counts_.data()[ray])};
    }
    [[nodiscard]] const TracedRay<T>& end(std::size_t ray) const { return ends_.data()[ray]; }

  private:
    std::size_t most_events_;
    PinnedArray<SurfaceEvent<T>> events_;
    PinnedArray<std::int32_t> counts_;
    PinnedArray<TracedRay<T>> ends_;
};

extern template class DeviceEvents<float>;
extern template class DeviceEvents<double>;

}  // namespace lensproof::optics
