// engine/render/camera/device_paths.h — camera paths out of a lens, traced on a GPU.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "engine/device/device_buffer.h"
#include "engine/device/parcel.h"
#include "engine/device/shared_device.h"
#include "engine/optics/device/device_lens.h"
#include "engine/render/camera/lens_paths.h"
#include "engine/render/camera/packet/path_job.h"

namespace lensproof::render {

/// A lens with its pupil in a device's memory, for the paths of all threads.
template <class T>
class DeviceCamera {
  public:
    /// `pupil` has tables. Throws device::Error where they do not fit.
    DeviceCamera(const device::Device& device, const optics::SpectralLens<T>& lens, const pupil::PupilSlices& pupil);

    [[nodiscard]] const optics::LensView<T>& lens() const { return lens_.view(); }
    [[nodiscard]] const pupil::PupilSliceTables& pupil() const { return tables_; }
    [[nodiscard]] const sampler_detail::DirectionNumbers* directions() const { return directions_; }

  private:
    optics::DeviceLens<T> lens_;
    device::Parcel parcel_;
    pupil::PupilSliceTables tables_;
    const sampler_detail::DirectionNumbers* directions_ = nullptr;
};

/// The paths of BasicLensPaths, filled on a device a piece at a time: the next one is on its way while one is gone
/// through. Where the device fails the paths go on from where they are on this machine's processors, with the same
/// bits. For one thread; film points are drawn from the box.
template <class T>
class DevicePaths {
  public:
    /// All outlive this. `fallback`: the same paths on this machine.
    DevicePaths(device::SharedDevice& device, const DeviceCamera<T>& camera, const FilmSampling& film, double pupil_z,
                BasicLensPaths<T> fallback);
    DevicePaths(DevicePaths&&) noexcept = default;
    DevicePaths& operator=(DevicePaths&&) noexcept = default;
    /// With pieces of its own, for another thread: to be started.
    DevicePaths(const DevicePaths& other)
        : DevicePaths(*other.device_, *other.camera_, other.film_, other.pupil_z_, other.fallback_) {}
    DevicePaths& operator=(const DevicePaths&) = delete;
    ~DevicePaths() = default;

    void start(const CameraPathRange& range);
    bool fill(CameraPathBuffer& buffer);
    [[nodiscard]] std::int64_t started() const { return started_ + fallback_.started(); }

  private:
    static constexpr std::size_t kPiece = std::size_t{1} << 15U;  // paths

    /// Some paths, here and on the device.
    struct Piece {
        explicit Piece(const device::Device& device);

        device::Buffer buffer;
        DevicePathColumns here;
        DevicePathColumns there;
        std::uint64_t first = 0;  // of the range
        std::size_t size = 0;     // 0: nothing is on its way or left
        std::size_t next = 0;     // path to be given out
        bool is_here = false;
    };

    /// Starts the range's next paths in a piece, if there are any.
    void start_piece(Piece& piece);
    void give(Piece& piece, CameraPathBuffer& buffer);
    /// Until the buffer is full or the range ends; throws device::Error.
    void fill_from_device(CameraPathBuffer& buffer);

    device::SharedDevice* device_;
    const DeviceCamera<T>* camera_;
    FilmSampling film_;
    double pupil_z_;
    BasicLensPaths<T> fallback_;
    std::optional<std::array<Piece, 2>> pieces_;  // none before the first range, and once the device has failed
    std::size_t current_ = 0;                     // that paths are given out of
    CameraPathRange range_;
    std::uint64_t started_pieces_ = 0;  // up to which sample of the range
    std::uint64_t given_ = 0;           // likewise
    std::int64_t started_ = 0;
};

extern template class DeviceCamera<float>;
extern template class DeviceCamera<double>;
extern template class DevicePaths<float>;
extern template class DevicePaths<double>;

}  // namespace lensproof::render
