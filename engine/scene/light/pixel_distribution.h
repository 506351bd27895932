// engine/scene/light/pixel_distribution.h — pixels drawn as often as they weigh.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "engine/base/large_pages.h"

namespace lensproof::scene {

/// The pixels of a picture, each drawn with a probability in proportion to its weight, a row by the first number and a
/// pixel of it by the second, so that even points stay even.
///
/// By inversion of running sums with guide tables (H.-C. Chen, Y. Asau, "On Generating Random Variates from an
/// Empirical Distribution", AIIE Transactions 6, 1974). Sums are whole numbers of 2⁻³²: their differences are exactly
/// the probabilities drawn with and add up to exactly 1, in half the memory of doubles. Whatever weighs anything has at
/// least 2⁻³² of its row, and whatever has a weight has a row of at least 2⁻³².
class PixelDistribution {
  public:
    PixelDistribution() = default;
    /// `weights`: row after row, none negative, one at least positive; those of each row are multiplied
    /// by its factor.
    PixelDistribution(int width, const std::vector<float>& weights, const std::vector<double>& row_factors);

    /// Where two numbers in [0, 1) fall: a pixel and how far into it, evenly, and its probability.
    struct Draw {
        std::size_t column = 0;
        std::size_t row = 0;
        double x = 0.0;  // of the picture's width, from its left
        double y = 0.0;  // of its height, from its top
        double probability = 0.0;
    };
    [[nodiscard]] Draw draw(double u1, double u2) const;
    /// Asks memory for what `draw` will read of these numbers.
    void expect(double u1, double u2) const;
    [[nodiscard]] double probability(std::size_t column, std::size_t row) const;
    void expect_probability(std::size_t column, std::size_t row) const {
        __builtin_prefetch(&pixels_[row * width_ + column]);
    }

    [[nodiscard]] std::size_t width() const { return width_; }
    [[nodiscard]] std::size_t height() const { return rows_.size(); }

  private:
    using Sums = std::vector<std::uint32_t, LargePages<std::uint32_t>>;

    [[nodiscard]] std::span<const std::uint32_t> pixels_of(std::size_t row) const {
        return std::span(pixels_).subspan(row * width_, width_);
    }

    [[nodiscard]] std::span<const std::uint32_t> guides_of(std::size_t row) const {
        const std::size_t count = pixel_guides_.size() / height();
        return std::span(pixel_guides_).subspan(row * count, count);
    }

    std::size_t width_ = 0;
    Sums rows_;    // the sum of all before each
    Sums pixels_;  // the same within each row, row after row
    Sums row_guides_;
    Sums pixel_guides_;  // of each row
};

}  // namespace lensproof::scene
