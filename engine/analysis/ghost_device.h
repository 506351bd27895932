// engine/analysis/ghost_device.h — a device that traces many rays of a ghost at a time.
#pragma once
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "engine/analysis/ghost_beam.h"
#include "engine/device/device_buffer.h"
#include "engine/device/shared_device.h"
#include "engine/optics/device/device_lens.h"

namespace lensproof::analysis {

struct GhostRays;  // ghost_job.h

/// A lens in a device's memory, and what the functions of ghost_beam.h ask of it, to the same bits but for what
/// coatings let pass: nothing where the device fails. For any number of threads.
class GhostDevice {
  public:
    /// Throws device::Error where the lens does not fit.
    GhostDevice(std::shared_ptr<device::SharedDevice> device, const optics::TraceLens<double>& lens);

    std::optional<std::vector<std::optional<Landing>>> landings(const GhostScene& scene, const optics::GhostPath& path,
                                                                std::span<const Vec2d> offsets);
    std::optional<std::vector<LandingMargins>> margins(const GhostScene& scene, const optics::GhostPath& path,
                                                       std::span<const Vec2d> offsets);
    std::optional<std::vector<RimRay>> rim_rays(const GhostScene& scene, const optics::GhostPath& path,
                                                std::span<const Vec2d> offsets);

  private:
    /// use(buffer), of a buffer of at least so many bytes that nobody else uses; nothing where the device fails.
    template <class Use>
    auto with_buffer(std::size_t bytes, const Use& use)
        -> std::optional<decltype(use(std::declval<device::Buffer&>()))>;
    /// What jobs are told, sent on its way.
    [[nodiscard]] GhostRays rays(const GhostScene& scene, const optics::GhostPath& path, std::span<const Vec2d> offsets,
                                 device::Buffer& buffer) const;

    std::shared_ptr<device::SharedDevice> device_;
    optics::DeviceLens<double> lens_;
    std::mutex mutex_;
    std::vector<std::unique_ptr<device::Buffer>> idle_;
};

}  // namespace lensproof::analysis
