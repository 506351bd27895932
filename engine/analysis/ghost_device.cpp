#include "engine/analysis/ghost_device.h"

#include <algorithm>
#include <bit>
#include <utility>

#include "engine/analysis/ghost_job.h"

namespace lensproof::analysis {

namespace {

optics::SpectralLens<double> at_one(const optics::TraceLens<double>& lens) {
    return optics::SpectralLens<double>({lens});
}

std::size_t bytes_of_rays(const optics::GhostPath& path, std::span<const Vec2d> offsets) {
    return device::Buffer::bytes_for<int>(path.size()) + device::Buffer::bytes_for<Vec2d>(offsets.size());
}

}  // namespace

GhostDevice::GhostDevice(std::shared_ptr<device::SharedDevice> device, const optics::TraceLens<double>& lens)
    : device_(std::move(device)), lens_(device_->device(), at_one(lens)) {}

template <class Use>
auto GhostDevice::with_buffer(std::size_t bytes, const Use& use)
    -> std::optional<decltype(use(std::declval<device::Buffer&>()))> {
    if (device_->has_failed()) {
        return std::nullopt;
    }
    try {
        std::unique_ptr<device::Buffer> buffer;
        {
            const std::scoped_lock lock(mutex_);
            if (!idle_.empty()) {
                buffer = std::move(idle_.back());
                idle_.pop_back();
            }
        }
        if (!buffer || buffer->bytes() < bytes) {
            buffer = std::make_unique<device::Buffer>(device_->device(), std::bit_ceil(bytes));
        }
        buffer->clear();
        auto result = use(*buffer);
        const std::scoped_lock lock(mutex_);
        idle_.push_back(std::move(buffer));
        return result;
    } catch (const device::Error& error) {
        device_->fail(error.what());
        return std::nullopt;
    }
}

GhostRays GhostDevice::rays(const GhostScene& scene, const optics::GhostPath& path, std::span<const Vec2d> offsets,
                            device::Buffer& buffer) const {
    return {.lens = lens_.view(),
            .beam = scene.beam,
            .mirrors = scene.mirrors,
            .image_radius = scene.image_radius,
            .path = {buffer.send(std::span<const int>(path)), path.size()},
            .offsets = buffer.send(offsets)};
}

std::optional<std::vector<std::optional<Landing>>> GhostDevice::landings(const GhostScene& scene,
                                                                         const optics::GhostPath& path,
                                                                         std::span<const Vec2d> offsets) {
    const std::size_t size = offsets.size();
    const std::size_t bytes = bytes_of_rays(path, offsets) + device::Buffer::bytes_for<Landing, std::uint8_t>(size);
    return with_buffer(bytes, [&](device::Buffer& buffer) {
        const auto landings = buffer.column<Landing>(size);
        const auto lands = buffer.column<std::uint8_t>(size);
        buffer.queue().run(LandingJob{{rays(scene, path, offsets, buffer)}, landings.there, lands.there},
                           static_cast<int>(size));
        buffer.download(landings, size);
        buffer.download(lands, size);
        buffer.queue().wait();
        std::vector<std::optional<Landing>> found(size);
        for (std::size_t i = 0; i < size; ++i) {
            if (lands.here[i] != 0) {
                found[i] = landings.here[i];
            }
        }
        return found;
    });
}

std::optional<std::vector<LandingMargins>> GhostDevice::margins(const GhostScene& scene, const optics::GhostPath& path,
                                                                std::span<const Vec2d> offsets) {
    const std::size_t size = offsets.size();
    // A margin an event, and that of the image circle: n reflections cross the lens n + 1 times.
    const std::size_t most = (path.size() + 1) * scene.lens.surfaces.size() + 1;
    const std::size_t bytes = bytes_of_rays(path, offsets) + device::Buffer::bytes_for<double>(size * most) +
                              device::Buffer::bytes_for<std::int32_t, std::uint8_t>(size);
    return with_buffer(bytes, [&](device::Buffer& buffer) {
        const auto margins = buffer.column<double>(size * most);
        const auto counts = buffer.column<std::int32_t>(size);
        const auto arrives = buffer.column<std::uint8_t>(size);
        buffer.queue().run(MarginJob{{rays(scene, path, offsets, buffer)},
                                     margins.there,
                                     counts.there,
                                     arrives.there,
                                     static_cast<int>(most)},
                           static_cast<int>(size));
        buffer.download(margins, size * most);
        buffer.download(counts, size);
        buffer.download(arrives, size);
        buffer.queue().wait();
        std::vector<LandingMargins> found(size);
        for (std::size_t i = 0; i < size; ++i) {
            const double* first = margins.here + i * most;
            found[i] = {.margins = {first, first + counts.here[i]}, .arrives = arrives.here[i] != 0};
        }
        return found;
    });
}

std::optional<std::vector<RimRay>> GhostDevice::rim_rays(const GhostScene& scene, const optics::GhostPath& path,
                                                         std::span<const Vec2d> offsets) {
    const std::size_t size = offsets.size();
    const std::size_t bytes = bytes_of_rays(path, offsets) + device::Buffer::bytes_for<RimRay>(size);
    return with_buffer(bytes, [&](device::Buffer& buffer) {
        const auto found = buffer.column<RimRay>(size);
        buffer.queue().run(RimRayJob{{rays(scene, path, offsets, buffer)}, found.there}, static_cast<int>(size));
        buffer.download(found, size);
        buffer.queue().wait();
        return std::vector<RimRay>(found.here, found.here + size);
    });
}

}  // namespace lensproof::analysis
