// engine/base/twin.h — two packs in step, as a number type for loops that wait for their own results.
#pragma once

namespace lensproof {

template <class Mask>
struct TwinMask {
    Mask first;
    Mask second;

    friend TwinMask operator&&(const TwinMask& a, const TwinMask& b) {
        return {a.first && b.first, a.second && b.second};
    }
    friend TwinMask operator||(const TwinMask& a, const TwinMask& b) {
        return {a.first || b.first, a.second || b.second};
    }
    friend TwinMask operator!(const TwinMask& a) { return {!a.first, !a.second}; }
    friend bool any(const TwinMask& mask) { return any(mask.first || mask.second); }
};

/// Twice as many numbers as a Pack's: while one half waits for a result of its own (tables, roots, quotients), the
/// processor has the other's to do. For chains that are too long for it to see beyond their end.
template <class Pack>
class Twin {
  public:
    using Mask = TwinMask<typename Pack::Mask>;
    using Number = typename Pack::Number;
    static constexpr int kLanes = 2 * Pack::kLanes;

    Twin() = default;
    explicit Twin(Number everywhere) : first_(everywhere), second_(everywhere) {}
    Twin(const Pack& first, const Pack& second) : first_(first), second_(second) {}

    /// As those of Pack, aligned to the size of a pack.
    template <class Other>
    static Twin load(const Other* from) {
        return {Pack::load(from), Pack::load(from + Pack::kLanes)};
    }
    template <class Other>
    void store(Other* to) const {
        first_.store(to);
        second_.store(to + Pack::kLanes);
    }

    friend Twin operator-(const Twin& a) { return {-a.first_, -a.second_}; }
    friend Twin operator+(const Twin& a, const Twin& b) { return {a.first_ + b.first_, a.second_ + b.second_}; }
    friend Twin operator-(const Twin& a, const Twin& b) { return {a.first_ - b.first_, a.second_ - b.second_}; }
    friend Twin operator*(const Twin& a, const Twin& b) { return {a.first_ * b.first_, a.second_ * b.second_}; }
    friend Twin operator/(const Twin& a, const Twin& b) { return {a.first_ / b.first_, a.second_ / b.second_}; }
    friend Mask operator<(const Twin& a, const Twin& b) { return {a.first_ < b.first_, a.second_ < b.second_}; }
    friend Mask operator>(const Twin& a, const Twin& b) { return {a.first_ > b.first_, a.second_ > b.second_}; }
    friend Mask operator<=(const Twin& a, const Twin& b) { return {a.first_ <= b.first_, a.second_ <= b.second_}; }

    friend Twin whole(const Twin& a) { return {whole(a.first_), whole(a.second_)}; }
    friend Twin sqrt(const Twin& a) { return {sqrt(a.first_), sqrt(a.second_)}; }

    friend Twin select(const Mask& mask, const Twin& a, const Twin& b) {
        return {select(mask.first, a.first_, b.first_), select(mask.second, a.second_, b.second_)};
    }

    /// An index a lane (look_up.h).
    class Index {
      public:
        explicit Index(const Twin& number) : first_(number.first_), second_(number.second_) {}

        template <class Entry>
        [[nodiscard]] Twin look_up(const Entry* table) const {
            return {first_.look_up(table), second_.look_up(table)};
        }

      private:
        typename Pack::Index first_;
        typename Pack::Index second_;
    };

  private:
    Pack first_;
    Pack second_;
};

}  // namespace lensproof
