// engine/optics/pack.h — several numbers in step, as a number type for the tracer.
#pragma once
#include <experimental/simd>

namespace lensproof {

/// A truth value for each lane of a pack.
template <class Scalar, int N>
class PackMask {
  public:
    using Lanes = std::experimental::fixed_size_simd_mask<Scalar, N>;

    PackMask() = default;
    explicit PackMask(bool everywhere) : lanes_(everywhere) {}
    explicit PackMask(const Lanes& lanes) : lanes_(lanes) {}

    bool operator[](int lane) const { return lanes_[static_cast<std::size_t>(lane)]; }
    [[nodiscard]] const Lanes& lanes() const { return lanes_; }

    friend PackMask operator&&(const PackMask& a, const PackMask& b) { return PackMask(a.lanes_ && b.lanes_); }
    friend PackMask operator||(const PackMask& a, const PackMask& b) { return PackMask(a.lanes_ || b.lanes_); }
    friend PackMask operator!(const PackMask& a) { return PackMask(!a.lanes_); }

    /// Whether any lane holds.
    friend bool any(const PackMask& mask) { return std::experimental::any_of(mask.lanes_); }

  private:
    Lanes lanes_{};
};

/// N floats or doubles on which every operation acts lane by lane, on the processor's vectors (ISO/IEC TS 19570:2018,
/// data-parallel types). Each operation rounds as that of a single number does (IEEE 754), so a lane that is computed
/// like a scalar has the scalar's bits.
template <class Scalar, int N>
class Pack {
  public:
    using Lanes = std::experimental::fixed_size_simd<Scalar, N>;
    using Mask = PackMask<Scalar, N>;

    Pack() = default;
    explicit Pack(Scalar everywhere) : lanes_(everywhere) {}
    explicit Pack(const Lanes& lanes) : lanes_(lanes) {}

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

    friend Pack abs(const Pack& a) { return Pack(std::experimental::abs(a.lanes_)); }
    friend Pack sqrt(const Pack& a) { return Pack(std::experimental::sqrt(a.lanes_)); }

    /// Lane by lane, `a` where `mask` holds, else `b`.
    friend Pack select(const Mask& mask, const Pack& a, const Pack& b) {
        Pack chosen = b;
        std::experimental::where(mask.lanes(), chosen.lanes_) = a.lanes_;
        return chosen;
    }

  private:
    Lanes lanes_{};
};

}  // namespace lensproof
