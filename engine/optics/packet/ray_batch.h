// engine/optics/packet/ray_batch.h — many rays in structure of arrays, as the packet tracer takes and leaves them.
#pragma once
#include <cstdint>
#include <new>
#include <vector>

#include "engine/base/ray.h"
#include "engine/optics/ray_status.h"

namespace lensproof::optics {

/// What the widest packets ask of memory: their alignment in bytes, and how many lanes they may touch at once.
inline constexpr std::size_t kPacketAlignment = 64;
inline constexpr int kMostLanes = 16;

template <class T>
struct PacketAllocator {
    using value_type = T;
    PacketAllocator() = default;
    template <class Other>
    explicit PacketAllocator(const PacketAllocator<Other>&) {}
    T* allocate(std::size_t count) {
        return static_cast<T*>(::operator new(count * sizeof(T), std::align_val_t(kPacketAlignment)));
    }
    void deallocate(T* column, std::size_t) { ::operator delete(column, std::align_val_t(kPacketAlignment)); }
    friend bool operator==(const PacketAllocator&, const PacketAllocator&) { return true; }
};

template <class T>
using PacketColumn = std::vector<T, PacketAllocator<T>>;

/// How long a column is of so many: by what fills the last packet longer.
constexpr std::size_t padded(int count) {
    const auto packets = static_cast<std::size_t>((count + kMostLanes - 1) / kMostLanes);
    return packets * kMostLanes;
}

/// Rays in columns of someone else's memory, each as in RayBatch below: aligned for packets, and as long as fills the
/// last one.
template <class T>
struct RayColumns {
    T* x;
    T* y;
    T* z;
    T* dx;
    T* dy;
    T* dz;
    T* optical_path;
    T* transmittance;
    const std::uint16_t* wavelength;  // null will do where the lens has one
    RayStatus* status;
    std::int16_t* surface;
    int size;
};

/// Up to `capacity` rays in lens space, a column a quantity. Columns are longer than that by what fills the last
/// packet.
template <class T>
struct RayBatch {
    explicit RayBatch(int most)
        : origin{column(most), column(most), column(most)},
          direction{column(most), column(most), column(most)},
          optical_path(column(most)),
          transmittance(column(most)),
          wavelength(padded(most)),
          status(padded(most)),
          surface(padded(most)),
          capacity(most) {}

    struct Vectors {
        PacketColumn<T> x;
        PacketColumn<T> y;
        PacketColumn<T> z;
    };

    Vectors origin;                // mm; given, then on the last surface that the ray reached
    Vectors direction;             // of unit length; given, then after that surface
    PacketColumn<T> optical_path;  // as TracedRay has them, where `trace_batch` is asked for them
    PacketColumn<T> transmittance;
    PacketColumn<std::uint16_t> wavelength;  // given: which of the lens's wavelengths
    PacketColumn<RayStatus> status;
    PacketColumn<std::int16_t> surface;
    int capacity = 0;
    int size = 0;  // rays in use

    void set(int i, const Ray<T>& ray) {
        const auto put = [i](Vectors& to, const Vec3<T>& from) {
            to.x[static_cast<std::size_t>(i)] = from.x;
            to.y[static_cast<std::size_t>(i)] = from.y;
            to.z[static_cast<std::size_t>(i)] = from.z;
        };
        put(origin, ray.origin);
        put(direction, ray.direction);
    }

    /// A packet of rays, from the i-th on, which is the first of a packet.
    template <class Numbers>
    void store(int i, const Ray<Numbers>& rays) {
        const auto put = [i](Vectors& to, const Vec3<Numbers>& from) {
            from.x.store(to.x.data() + i);
            from.y.store(to.y.data() + i);
            from.z.store(to.z.data() + i);
        };
        put(origin, rays.origin);
        put(direction, rays.direction);
    }

    [[nodiscard]] Ray<T> ray(int i) const {
        const auto at = static_cast<std::size_t>(i);
        return {{origin.x[at], origin.y[at], origin.z[at]}, {direction.x[at], direction.y[at], direction.z[at]}};
    }

    /// The rays in use, for as long as this stays where it is.
    [[nodiscard]] RayColumns<T> columns() {
        return {.x = origin.x.data(),
                .y = origin.y.data(),
                .z = origin.z.data(),
                .dx = direction.x.data(),
                .dy = direction.y.data(),
                .dz = direction.z.data(),
                .optical_path = optical_path.data(),
                .transmittance = transmittance.data(),
                .wavelength = wavelength.data(),
                .status = status.data(),
                .surface = surface.data(),
                .size = size};
    }

  private:
    static PacketColumn<T> column(int rays) { return PacketColumn<T>(padded(rays)); }
};

}  // namespace lensproof::optics
