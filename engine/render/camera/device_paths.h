// engine/render/camera/device_paths.h — camera paths out of a lens, traced on a GPU.
#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

#include "engine/device/device_buffer.h"
#include "engine/device/parcel.h"
#include "engine/device/shared_device.h"
#include "engine/optics/device/device_lens.h"
#include "engine/render/camera/lens_paths.h"
#include "engine/render/camera/packet/path_job.h"

namespace lensproof::render {

/// Some paths on their way from a device.
struct DevicePathPiece {
    static constexpr std::size_t kMost = std::size_t{1} << 15U;  // paths

    explicit DevicePathPiece(const device::Device& device);

    device::Buffer buffer;
    DevicePathColumns here;
    DevicePathColumns there;
    std::uint64_t first = 0;  // of the range
    std::size_t size = 0;     // 0: nothing is on its way or left
    std::size_t next = 0;     // path to be given out
    bool is_here = false;
};

/// Pieces that nobody uses at present: a GPU takes milliseconds to make one. For any number of threads.
class SparePathPieces {
  public:
    /// Throws device::Error where there is no memory for one more.
    std::unique_ptr<DevicePathPiece> take(const device::Device& device);
    void give_back(std::unique_ptr<DevicePathPiece> piece);

  private:
    std::mutex mutex_;
    std::vector<std::unique_ptr<DevicePathPiece>> spare_;
};

/// A lens with its pupil in a device's memory, for the paths of all threads.
template <class T>
class DeviceCamera {
  public:
    /// `pupil` has tables. Throws device::Error where they do not fit.
    DeviceCamera(const device::Device& device, const optics::SpectralLens<T>& lens, const pupil::PupilSlices& pupil);

    [[nodiscard]] const optics::LensView<T>& lens() const { return lens_.view(); }
    [[nodiscard]] const pupil::PupilSliceTables& pupil() const { return tables_; }
    [[nodiscard]] const sampler_detail::DigitPoints* sobol_points() const { return sobol_points_; }
    [[nodiscard]] SparePathPieces& spare_pieces() const { return spare_pieces_; }

  private:
    optics::DeviceLens<T> lens_;
    device::Parcel parcel_;
    pupil::PupilSliceTables tables_;
    const sampler_detail::DigitPoints* sobol_points_ = nullptr;
    mutable SparePathPieces spare_pieces_;
};

/// The paths of BasicLensPaths, filled on a device a piece at a time: the next one is on its way while one is gone
/// through. Where the device fails the paths go on from where they are on this machine's processors, with the same
/// bits. For one thread; film points are drawn from the box.
template <class T>
class DevicePaths {
  public:
    /// All outlive this. `has_film`: whether film points and etendues are filled in too. `fallback`: the same paths on
    /// this machine.
    DevicePaths(device::SharedDevice& device, const DeviceCamera<T>& camera, const FilmSampling& film, double pupil_z,
                bool has_film, BasicLensPaths<T> fallback);
    DevicePaths(DevicePaths&&) noexcept = default;
    DevicePaths& operator=(DevicePaths&&) = delete;
    /// With pieces of its own, for another thread: to be started.
    DevicePaths(const DevicePaths& other)
        : DevicePaths(*other.device_, *other.camera_, other.film_, other.pupil_z_, other.has_film_, other.fallback_) {}
    DevicePaths& operator=(const DevicePaths&) = delete;
    ~DevicePaths();

    void start(const CameraPathRange& range);
    bool fill(CameraPathBuffer& buffer);
    [[nodiscard]] std::int64_t started() const { return started_ + fallback_.started(); }

  private:
    using Piece = DevicePathPiece;

    /// Starts the range's next paths in a piece, if there are any.
    void start_piece(Piece& piece);
    void give(Piece& piece, CameraPathBuffer& buffer);
    /// Until the buffer is full or the range ends; throws device::Error.
    void fill_from_device(CameraPathBuffer& buffer);

    BasicLensPaths<T> fallback_;
    device::SharedDevice* device_;
    const DeviceCamera<T>* camera_;
    FilmSampling film_;
    double pupil_z_;
    std::array<std::unique_ptr<Piece>, 2> pieces_;  // none before the first range, and once the device has failed
    std::size_t current_ = 0;                       // that paths are given out of
    std::vector<std::uint32_t> leaving_;            // those that are being given, by their place in the piece
    CameraPathRange range_;
    std::uint64_t started_pieces_ = 0;  // up to which sample of the range
    std::uint64_t given_ = 0;           // likewise
    std::int64_t started_ = 0;
    bool has_film_;
};

extern template class DeviceCamera<float>;
extern template class DeviceCamera<double>;
extern template class DevicePaths<float>;
extern template class DevicePaths<double>;

}  // namespace lensproof::render
