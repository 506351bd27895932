// engine/scene/light/pixel_distribution.h — places of a picture, drawn where it is bright.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "engine/base/large_pages.h"
#include "engine/base/vec.h"

namespace lensproof::scene {

/// A density over a picture, the unit square from its top left corner (x to the right, y down), even within cells. The
/// first number draws a row of blocks and the second a block of it, so that even points stay even, and a cell of that.
///
/// A draw must not wait for memory: of a picture of any size there are at most 256 × 256 blocks, in half a MiB, and 8 ×
/// 4 cells, of 64 bytes together, in those 8192 at most where these lower the variance most. Of all densities over the
/// same cells it has the least variance: ∫ f²/p is least where p goes as the root of the mean square of f.
///
/// By inversion of running sums with guide tables (H.-C. Chen, Y. Asau, "On Generating Random Variates from an
/// Empirical Distribution", AIIE Transactions 6, 1974). Sums are whole numbers: their differences are exactly the
/// probabilities drawn with and add up to exactly 1. What weighs anything has at least 2⁻³² of all rows, 2⁻³² of its
/// row's blocks, 2⁻¹⁶ of its block's cells.
class PixelDistribution {
  public:
    /// The mean square of the picture in each pixel of a row.
    using SquaresOfRow = std::function<std::vector<double>(int row)>;

    PixelDistribution() = default;
    /// Of a picture that is not black.
    PixelDistribution(int width, int height, const SquaresOfRow& squares_of_row);

    /// Where two numbers in [0, 1) fall, and the density there.
    struct Draw {
        Vec2d at;
        double pdf = 0.0;
    };
    [[nodiscard]] Draw draw(const Vec2d& numbers) const;
    /// The same of many, while memory brings what the next ones will read.
    void draw(std::span<const Vec2d> numbers, std::span<Draw> draws) const;
    [[nodiscard]] double pdf(const Vec2d& at) const;
    void find_pdfs(std::span<const Vec2d> at, std::span<double> pdfs) const;

  private:
    static constexpr std::size_t kAcross = 8;
    static constexpr std::size_t kDown = 4;
    static constexpr std::size_t kCells = kAcross * kDown;

    /// A row, or a block of a row; after the last of them stand some that nothing falls in.
    struct Step {
        std::uint32_t before = 0;  // the sum of those before it
        std::uint16_t guide = 0;   // of as many equal parts of the whole as there are steps, where this one begins
        std::uint16_t cells = 0;   // index; of a block
    };
    using Cells = std::array<std::uint16_t, kCells>;  // the sum of those before each, row by row

    /// The step that a number falls in, and how far into it.
    struct Found {
        std::size_t step = 0;
        double fraction = 0.0;  // in [0, 1)
        double width = 0.0;
    };
    /// The block and the cell that a point lies in.
    struct Place {
        std::size_t row = 0;
        std::size_t column = 0;
        std::size_t cell = 0;
    };
    [[nodiscard]] static std::size_t part_at(std::size_t steps, double u);
    [[nodiscard]] static Found find(const Step* steps, std::size_t count, double u);
    [[nodiscard]] Draw draw_in(const Found& row, const Found& block) const;
    [[nodiscard]] Place place(const Vec2d& at) const;
    [[nodiscard]] double pdf(const Place& place) const;
    [[nodiscard]] static double width_of(const Step* step) { return step[1].before - step[0].before; }
    [[nodiscard]] static double width_of(const Cells& sums, std::size_t cell);
    static void fill(Step* steps, std::span<const double> weights);
    [[nodiscard]] double density(double row_width, double block_width, double cell_width) const;
    [[nodiscard]] const Step* blocks_of(std::size_t row) const { return blocks_.data() + row * (columns_ + kAfter); }
    [[nodiscard]] const Cells& cells_of(std::size_t row, std::size_t column) const {
        return cells_[blocks_of(row)[column].cells];
    }

    static constexpr std::size_t kAfter = 3;  // steps after the last
    std::size_t columns_ = 0;
    std::size_t row_count_ = 0;
    std::vector<Step> rows_;
    std::vector<Step, LargePages<Step>> blocks_;   // row after row
    std::vector<Cells, LargePages<Cells>> cells_;  // the first even, for blocks that have none of their own
};

}  // namespace lensproof::scene
