// engine/render/sampling/sampler.h — well-spread sample points, each a pure function of (seed, pixel, sample).
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>

namespace lensproof::render {

namespace sampler_detail {

/// A hash with good avalanche (the finaliser of SplitMix64; Steele, Lea, Flood, OOPSLA 2014).
[[gnu::always_inline]] constexpr std::uint64_t mixed(std::uint64_t x) {
    x += 0x9e3779b97f4a7c15ULL;
    x = (x ^ (x >> 30U)) * 0xbf58476d1ce4e5b9ULL;
    x = (x ^ (x >> 27U)) * 0x94d049bb133111ebULL;
    return x ^ (x >> 31U);
}

[[gnu::always_inline]] constexpr std::uint32_t reversed_bits(std::uint32_t x) {
    x = ((x >> 1U) & 0x55555555U) | ((x & 0x55555555U) << 1U);
    x = ((x >> 2U) & 0x33333333U) | ((x & 0x33333333U) << 2U);
    x = ((x >> 4U) & 0x0f0f0f0fU) | ((x & 0x0f0f0f0fU) << 4U);
    x = ((x >> 8U) & 0x00ff00ffU) | ((x & 0x00ff00ffU) << 8U);
    return (x >> 16U) | (x << 16U);
}

/// A hash in which every bit depends on those below it alone: a nested uniform scramble of bits that come in reverse
/// (Laine & Karras 2011, as improved by Burley, JCGT 9(4), 2020, listing 3).
[[gnu::always_inline]] constexpr std::uint32_t laine_karras(std::uint32_t reversed, std::uint32_t seed) {
    std::uint32_t x = reversed + seed;
    x ^= x * 0x6c50b47cU;
    x ^= x * 0xb82f1e52U;
    x ^= x * 0xc7afe638U;
    x ^= x * 0x8d22f6e6U;
    return x;
}

/// A number in (0, 1) from bits by Owen's scramble. The bits come in reverse.
[[gnu::always_inline]] constexpr double scrambled_number(std::uint32_t reversed, std::uint32_t seed) {
    return (reversed_bits(laine_karras(reversed, seed)) + 0.5) * 0x1p-32;
}

inline constexpr int kDimensions = 5;
using DirectionNumbers = std::array<std::array<std::uint32_t, 32>, kDimensions>;

/// Sobol's direction numbers for the first five dimensions (Joe & Kuo, SIAM J. Sci. Comput. 30, 2635, 2008).
constexpr DirectionNumbers make_direction_numbers() {
    struct Polynomial {
        unsigned degree;
        unsigned coefficients;
        std::array<std::uint32_t, 3> initial;
    };
    constexpr std::array<Polynomial, kDimensions - 1> kPolynomials = {
        Polynomial{1, 0, {1, 0, 0}}, Polynomial{2, 1, {1, 3, 0}}, Polynomial{3, 1, {1, 3, 1}},
        Polynomial{3, 2, {1, 1, 1}}};
    DirectionNumbers v{};
    for (unsigned bit = 0; bit < 32; ++bit) {
        v[0][bit] = 1U << (31 - bit);
    }
    for (std::size_t d = 1; d < kDimensions; ++d) {
        const Polynomial& p = kPolynomials[d - 1];
        for (unsigned bit = 0; bit < 32; ++bit) {
            if (bit < p.degree) {
                v[d][bit] = p.initial[bit] << (31 - bit);
                continue;
            }
            v[d][bit] = v[d][bit - p.degree] ^ (v[d][bit - p.degree] >> p.degree);
            for (unsigned k = 1; k < p.degree; ++k) {
                if ((p.coefficients >> (p.degree - 1 - k)) & 1U) {
                    v[d][bit] ^= v[d][bit - k];
                }
            }
        }
    }
    return v;
}

inline constexpr DirectionNumbers kDirections = make_direction_numbers();

using PointBits = std::array<std::uint32_t, kDimensions>;

/// The point of the unscrambled sequence, with its bits in reverse, as the scramble wants them. It is linear in the
/// bits of `sample`: the point of a ^ b is that of a ^ that of b.
constexpr PointBits sobol_point_by_bits(std::uint32_t sample) {
    PointBits x{};
    for (int d = 0; d < kDimensions; ++d) {
        for (unsigned bit = 0; bit < 32; ++bit) {
            x[d] ^= ((sample >> bit) & 1U) * kDirections[d][bit];
        }
        x[d] = reversed_bits(x[d]);
    }
    return x;
}

inline constexpr int kPlaces = 8;
/// Those of the samples of four bits, at each of their eight places.
using DigitPoints = std::array<std::array<PointBits, 16>, kPlaces>;

constexpr DigitPoints make_digit_points() {
    DigitPoints points{};
    for (std::uint32_t place = 0; place < kPlaces; ++place) {
        for (std::uint32_t digit = 0; digit < 16; ++digit) {
            points[place][digit] = sobol_point_by_bits(digit << (4 * place));
        }
    }
    return points;
}

inline constexpr DigitPoints kDigitPoints = make_digit_points();

/// The same in an eighth of the steps. `points`: kDigitPoints, from wherever they can be read.
[[gnu::always_inline]] constexpr PointBits sobol_point(std::uint32_t sample, const DigitPoints& points = kDigitPoints) {
    PointBits x{};
    for (int place = 0; place < kPlaces; ++place) {
        for (int d = 0; d < kDimensions; ++d) {
            x[d] ^= points[place][(sample >> (4 * place)) & 15U][d];
        }
    }
    return x;
}

/// The first points, a column a dimension.
inline constexpr std::uint32_t kBlock = 256;
using PointBlock = std::array<std::array<std::uint32_t, kBlock>, kDimensions>;

constexpr PointBlock make_first_points() {
    PointBlock block{};
    for (std::uint32_t i = 0; i < kBlock; ++i) {
        const PointBits x = sobol_point(i);
        for (int d = 0; d < kDimensions; ++d) {
            block[d][i] = x[d];
        }
    }
    return block;
}

inline constexpr PointBlock kFirstPoints = make_first_points();

}  // namespace sampler_detail

/// Five numbers in (0, 1), the `sample`-th point of a Sobol sequence that is Owen-scrambled per pixel and dimension:
/// points of a pixel are stratified in every dimension, pixels are independent of each other.
class PixelSampler {
  public:
    static constexpr int kDimensions = sampler_detail::kDimensions;

    [[gnu::always_inline]] constexpr PixelSampler(std::uint64_t seed, std::uint32_t pixel) {
        for (int d = 0; d < kDimensions; ++d) {
            scramble_[d] = scramble(stream(seed, pixel), d);
        }
    }

    // What a dimension's scramble follows from.
    [[gnu::always_inline]] static constexpr std::uint64_t stream(std::uint64_t seed, std::uint32_t pixel) {
        return sampler_detail::mixed(seed) ^ (static_cast<std::uint64_t>(pixel) << 8U);
    }
    [[gnu::always_inline]] static constexpr std::uint32_t scramble(std::uint64_t stream, int dimension) {
        return static_cast<std::uint32_t>(sampler_detail::mixed(stream + static_cast<std::uint64_t>(dimension)) >> 32U);
    }

    /// Inlined, so that numbers which nobody asks for are not made. `points`: as `sobol_point` has them.
    [[nodiscard, gnu::always_inline]] constexpr std::array<double, kDimensions> point(
        std::uint32_t sample, const sampler_detail::DigitPoints& points = sampler_detail::kDigitPoints) const {
        return scrambled(sampler_detail::sobol_point(sample, points));
    }

    /// The points of the samples `first` … `first` + `count` − 1, a column a dimension: what `point` gives, in a
    /// fraction of the time. Inlined everywhere, so that code for wider registers gets its own.
    [[gnu::always_inline]] constexpr void points(std::uint32_t first, std::uint32_t count,
                                                 const std::array<double*, kDimensions>& columns) const {
        using sampler_detail::kBlock;
        for (std::uint32_t done = 0; done < count;) {
            const std::uint32_t in_block = (first + done) % kBlock;
            const std::uint32_t end = std::min(count, done + (kBlock - in_block));
            const sampler_detail::PointBits block = sampler_detail::sobol_point(first + done - in_block);
            for (int d = 0; d < kDimensions; ++d) {
                const std::uint32_t* x = sampler_detail::kFirstPoints[d].data() + in_block;
                double* values = columns[d] + done;
                for (std::uint32_t i = 0; i < end - done; ++i) {
                    values[i] = sampler_detail::scrambled_number(x[i] ^ block[d], scramble_[d]);
                }
            }
            done = end;
        }
    }

  private:
    [[nodiscard, gnu::always_inline]] constexpr std::array<double, kDimensions> scrambled(
        const sampler_detail::PointBits& bits) const {
        std::array<double, kDimensions> values{};
        for (int d = 0; d < kDimensions; ++d) {
            values[d] = sampler_detail::scrambled_number(bits[d], scramble_[d]);
        }
        return values;
    }

    std::array<std::uint32_t, kDimensions> scramble_{};
};

}  // namespace lensproof::render
