// engine/device/parcel.h — arrays that go to a device together and stay there.
#pragma once
#include <cstddef>
#include <cstring>
#include <optional>
#include <span>
#include <type_traits>
#include <vector>

#include "engine/device/device_buffer.h"

namespace lensproof::device {

/// An array's place in a Parcel.
template <class T>
struct ParcelPlace {
    std::size_t offset = 0;
    std::size_t size = 0;
};

/// Packed first, then sent: from then on each array has its address on the device.
class Parcel {
  public:
    template <class T>
    ParcelPlace<T> add(std::span<const T> array) {
        const ParcelPlace<T> place = reserve<T>(array.size());
        set(place, array);
        return place;
    }
    template <class T>
    ParcelPlace<T> add(const std::vector<T>& array) {
        return add(std::span<const T>(array));
    }

    /// For what itself holds addresses: its place now, its content (`set`) between `allocate` and `send`.
    template <class T>
    ParcelPlace<T> reserve(std::size_t size) {
        static_assert(std::is_trivially_copyable_v<T>);
        const std::size_t offset = in_device_lines(bytes_.size());
        bytes_.resize(offset + size * sizeof(T));
        return {offset, size};
    }
    template <class T>
    void set(const ParcelPlace<T>& place, std::span<const T> array) {
        if (!array.empty()) {
            std::memcpy(bytes_.data() + place.offset, array.data(), array.size_bytes());
        }
    }

    void allocate(const Device& device) { memory_.emplace(device, Memory::Place::device, bytes_.size() + 1); }

    /// On the device; this outlives it.
    template <class T>
    [[nodiscard]] const T* address(const ParcelPlace<T>& place) const {
        return static_cast<const T*>(
            static_cast<const void*>(static_cast<const std::byte*>(memory_->get()) + place.offset));
    }
    template <class T>
    [[nodiscard]] std::span<const T> span(const ParcelPlace<T>& place) const {
        return {address(place), place.size};
    }

    void send(const Device& device) {
        Device::Queue queue(device);
        queue.upload(memory_->get(), bytes_.data(), bytes_.size());
        queue.wait();
        bytes_ = {};
    }

  private:
    std::vector<std::byte> bytes_;
    std::optional<Memory> memory_;
};

}  // namespace lensproof::device
