// engine/base/pack.h — several numbers in step, as a number type for the tracer.
#pragma once
#include <array>
#include <cstdint>
#include <experimental/simd>
#include <type_traits>

#include "engine/base/gather.h"
#include "engine/base/look_up.h"
#include "engine/base/simd_level.h"

namespace lensproof {

/// One number, or as many as a register of the instructions holds that the file is compiled for.
template <SimdLevel level, class Scalar>
using AbiOf = std::conditional_t<level == SimdLevel::scalar, std::experimental::simd_abi::scalar,
                                 std::experimental::simd_abi::native<Scalar>>;

/// A truth value for each lane of a pack.
template <class Scalar, class Abi>
class PackMask {
  public:
    using Lanes = std::experimental::simd_mask<Scalar, Abi>;

    PackMask() = default;
    explicit PackMask(bool everywhere) : lanes_(everywhere) {}
    explicit PackMask(const Lanes& lanes) : lanes_(lanes) {}

    bool operator[](int lane) const { return lanes_[static_cast<std::size_t>(lane)]; }
    [[nodiscard]] const Lanes& lanes() const { return lanes_; }

    friend PackMask operator&&(const PackMask& a, const PackMask& b) { return PackMask(a.lanes_ && b.lanes_); }
    friend PackMask operator||(const PackMask& a, const PackMask& b) { return PackMask(a.lanes_ || b.lanes_); }
    friend PackMask operator!(const PackMask& a) { return PackMask(!a.lanes_); }

    friend bool any(const PackMask& mask) { return std::experimental::any_of(mask.lanes_); }
    friend bool all(const PackMask& mask) { return std::experimental::all_of(mask.lanes_); }

  private:
    Lanes lanes_{};
};

/// As many floats or doubles as `Abi` says, on which every operation acts lane by lane, on the processor's vectors
/// (ISO/IEC TS 19570:2018, data-parallel types). Each operation rounds as that of a single number does (IEEE 754), so a
/// lane that is computed like a scalar has the scalar's bits.
///
/// Code for packs has to be inlined (`[[gnu::flatten]]`): a pack that is passed to a function lies in memory.
template <class Scalar, class Abi>
class Pack {
  public:
    using Lanes = std::experimental::simd<Scalar, Abi>;
    using Mask = PackMask<Scalar, Abi>;
    using Number = Scalar;
    static constexpr int kLanes = static_cast<int>(Lanes::size());

    Pack() = default;
    explicit Pack(Scalar everywhere) : lanes_(everywhere) {}
    explicit Pack(const Lanes& lanes) : lanes_(lanes) {}

    /// From kLanes numbers at `from`, perhaps of another type, which is aligned to their size in all; and back.
    template <class Other>
    static Pack load(const Other* from) {
        return Pack(Lanes(from, std::experimental::vector_aligned));
    }
    template <class Other>
    void store(Other* to) const {
        lanes_.copy_to(to, std::experimental::vector_aligned);
    }

    /// The pack of 0, 1, 2, …
    static Pack iota() {
        return Pack(Lanes([](auto lane) { return static_cast<Scalar>(lane); }));
    }

    /// value(lane) for each lane of `lanes`, else `otherwise`.
    template <class Value>
    static Pack by_lane(const Mask& lanes, Pack otherwise, const Value& value) {
        for (int lane = 0; lane < kLanes; ++lane) {
            if (lanes[lane]) {
                otherwise.set(lane, value(lane));
            }
        }
        return otherwise;
    }

    /// table[index[lane]] for each lane.
    template <class Entry, class Number>
    static Pack gather(const Entry* table, const Number* index) {
        return Pack(gathered<Lanes>(table, index));
    }

    /// The four numbers of rows[index[lane]] for each lane.
    template <class Row>
    static std::array<Pack, 4> gather_rows(const Row* rows, const std::uint16_t* index) {
        const std::array<Lanes, 4> columns = gathered_rows<Lanes>(rows, index);
        return {Pack(columns[0]), Pack(columns[1]), Pack(columns[2]), Pack(columns[3])};
    }

    [[nodiscard]] const Lanes& lanes() const { return lanes_; }
    Scalar operator[](int lane) const { return lanes_[static_cast<std::size_t>(lane)]; }
    void set(int lane, Scalar value) { lanes_[static_cast<std::size_t>(lane)] = value; }

    friend Pack operator-(const Pack& a) { return Pack(-a.lanes_); }
    friend Pack operator+(const Pack& a, const Pack& b) { return Pack(a.lanes_ + b.lanes_); }
    friend Pack operator-(const Pack& a, const Pack& b) { return Pack(a.lanes_ - b.lanes_); }
    friend Pack operator*(const Pack& a, const Pack& b) { return Pack(a.lanes_ * b.lanes_); }
    friend Pack operator/(const Pack& a, const Pack& b) { return Pack(a.lanes_ / b.lanes_); }
    friend Mask operator<(const Pack& a, const Pack& b) { return Mask(a.lanes_ < b.lanes_); }
    friend Mask operator>(const Pack& a, const Pack& b) { return Mask(a.lanes_ > b.lanes_); }
    friend Mask operator<=(const Pack& a, const Pack& b) { return Mask(a.lanes_ <= b.lanes_); }
    friend Mask operator>=(const Pack& a, const Pack& b) { return Mask(a.lanes_ >= b.lanes_); }
    friend Mask operator==(const Pack& a, const Pack& b) { return Mask(a.lanes_ == b.lanes_); }

    friend Pack whole(const Pack& a) { return Pack(std::experimental::trunc(a.lanes_)); }
    friend Pack abs(const Pack& a) { return Pack(std::experimental::abs(a.lanes_)); }
    friend Pack sqrt(const Pack& a) { return Pack(std::experimental::sqrt(a.lanes_)); }
    /// Of all lanes.
    friend Scalar least(const Pack& a) { return std::experimental::hmin(a.lanes_); }

    /// Lane by lane, `a` where `mask` holds, else `b`.
    friend Pack select(const Mask& mask, const Pack& a, const Pack& b) {
        Pack chosen = b;
        std::experimental::where(mask.lanes(), chosen.lanes_) = a.lanes_;
        return chosen;
    }

    /// An index a lane (look_up.h).
    class Index {
      public:
        explicit Index(const Pack& number) { number.store(at_.data()); }

        template <class Entry>
        [[nodiscard]] Pack look_up(const Entry* table) const {
            return gather(table, at_.data());
        }

      private:
        alignas(64) std::array<std::int32_t, kLanes> at_;
    };

  private:
    Lanes lanes_{};
};

}  // namespace lensproof
