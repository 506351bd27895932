// engine/device/device_buffer.h — columns that are filled on a device and read here, or the other way.
#pragma once
#include <algorithm>
#include <cassert>
#include <cstddef>
#include <span>
#include <type_traits>

#include "engine/device/device.h"

namespace lensproof::device {

/// Where columns begin, bytes: as a GPU's cache has its lines.
inline constexpr std::size_t kDeviceLine = 128;
constexpr std::size_t in_device_lines(std::size_t bytes) {
    return (bytes + kDeviceLine - 1) / kDeviceLine * kDeviceLine;
}

/// A column's place in both memories.
template <class T>
struct Column {
    static_assert(std::is_trivially_copyable_v<T>);

    T* here = nullptr;
    T* there = nullptr;
};

/// As much memory of a device as of this machine, dealt out as columns, and the queue that fills them. For one thread
/// at a time.
class Buffer {
  public:
    Buffer(const Device& device, std::size_t bytes)
        : queue_(device),
          there_(device, Memory::Place::device, bytes),
          here_(device, Memory::Place::pinned, bytes),
          bytes_(bytes) {}

    /// What columns of these types take, of `size` each.
    template <class... T>
    [[nodiscard]] static constexpr std::size_t bytes_for(std::size_t size) {
        return (in_device_lines(size * sizeof(T)) + ...);
    }

    /// The next column; not set.
    template <class T>
    Column<T> column(std::size_t size) {
        assert(used_ + size * sizeof(T) <= bytes_);
        const auto at = [&](const Memory& memory) {
            return static_cast<T*>(static_cast<void*>(static_cast<std::byte*>(memory.get()) + used_));
        };
        const Column<T> column{.here = at(here_), .there = at(there_)};
        used_ += in_device_lines(size * sizeof(T));
        return column;
    }
    /// Takes all columns back.
    void clear() { used_ = 0; }
    [[nodiscard]] std::size_t bytes() const { return bytes_; }

    [[nodiscard]] Device::Queue& queue() { return queue_; }
    /// A column of these, on its way there: its place there.
    template <class T>
    const T* send(std::span<const T> items) {
        const Column<T> column = this->column<T>(items.size());
        std::ranges::copy(items, column.here);
        upload(column, items.size());
        return column.there;
    }
    /// The first `size` of a column.
    template <class T>
    void upload(const Column<T>& column, std::size_t size) {
        queue_.upload(column.there, column.here, size * sizeof(T));
    }
    template <class T>
    void download(const Column<T>& column, std::size_t size) {
        queue_.download(column.here, column.there, size * sizeof(T));
    }
    /// All columns, in one go: each call takes a processor some microseconds.
    void download() { queue_.download(here_.get(), there_.get(), used_); }

  private:
    Device::Queue queue_;
    Memory there_;
    Memory here_;
    std::size_t bytes_;
    std::size_t used_ = 0;
};

}  // namespace lensproof::device
