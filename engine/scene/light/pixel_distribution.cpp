#include "engine/scene/light/pixel_distribution.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace lensproof::scene {

namespace {

constexpr std::uint32_t kChances = 0xFFFF'FFFF;   // of rows, and of a row's blocks
constexpr std::uint32_t kChancesABlock = 0xFFFF;  // of its cells
constexpr std::size_t kMostBlocks = 256;          // along either axis
constexpr std::size_t kMostWithCells = 8192;
constexpr double kBelowOne = 1.0 - 0x1p-53;

/// `pixels` along an axis in `count` parts: each touches the pixels in [begin, end).
struct Parts {
    std::size_t count = 0;
    std::size_t pixels = 0;

    [[nodiscard]] std::size_t begin(std::size_t part) const { return part * pixels / count; }
    [[nodiscard]] std::size_t end(std::size_t part) const { return ((part + 1) * pixels + count - 1) / count; }
};

std::vector<double> mean_squares(const Parts& across, const Parts& down,
                                 const PixelDistribution::SquaresOfRow& squares_of_row) {
    std::vector<double> means;
    means.reserve(across.count * down.count);
    std::vector<double> sums(across.pixels);
    for (std::size_t row = 0; row < down.count; ++row) {
        std::ranges::fill(sums, 0.0);
        for (std::size_t y = down.begin(row); y < down.end(row); ++y) {
            const std::vector<double> squares = squares_of_row(static_cast<int>(y));
            std::ranges::transform(sums, squares, sums.begin(), std::plus());
        }
        for (std::size_t column = 0; column < across.count; ++column) {
            const auto begin = sums.begin() + static_cast<std::ptrdiff_t>(across.begin(column));
            const auto end = sums.begin() + static_cast<std::ptrdiff_t>(across.end(column));
            const auto touched =
                static_cast<double>(end - begin) * static_cast<double>(down.end(row) - down.begin(row));
            means.push_back(std::accumulate(begin, end, 0.0) / touched);
        }
    }
    return means;
}

/// Chances by weight, `all` of them; what weighs anything has one before the rest goes by weight, the first has them
/// where nothing does. Of running sums, so that roundings do not add up.
std::vector<std::uint32_t> chances(std::span<const double> weights, std::uint32_t all) {
    const double total = std::accumulate(weights.begin(), weights.end(), 0.0);
    const auto is_lit = [](double weight) { return weight > 0.0; };
    const auto lit = static_cast<std::uint32_t>(std::ranges::count_if(weights, is_lit));
    std::vector<std::uint32_t> chances;
    chances.reserve(weights.size());
    double sum = 0.0;
    std::uint32_t before = 0;
    std::uint32_t last_lit = 0;
    for (const double weight : weights) {
        sum += weight;
        const auto up_to = static_cast<std::uint32_t>((total > 0.0 ? std::min(sum / total, 1.0) : 0.0) * (all - lit));
        last_lit = is_lit(weight) ? static_cast<std::uint32_t>(chances.size()) : last_lit;
        chances.push_back(up_to - before + (is_lit(weight) ? 1 : 0));
        before = up_to;
    }
    chances[last_lit] += all - lit - before;
    return chances;
}

/// The blocks whose weights fall most where they have cells, at most as many as may have them.
std::vector<std::size_t> worth_cells(std::span<const double> whole, std::span<const double> in_cells) {
    std::vector<std::size_t> best;
    for (std::size_t block = 0; block < whole.size(); ++block) {
        if (in_cells[block] < whole[block]) {
            best.push_back(block);
        }
    }
    std::ranges::stable_sort(best, std::greater(), [&](std::size_t block) { return whole[block] - in_cells[block]; });
    best.resize(std::min(best.size(), kMostWithCells));
    return best;
}

}  // namespace

PixelDistribution::PixelDistribution(int width, int height, const SquaresOfRow& squares_of_row) {
    const auto blocks_over = [](int pixels, std::size_t cells) {
        return std::min((static_cast<std::size_t>(pixels) + cells - 1) / cells, kMostBlocks);
    };
    columns_ = blocks_over(width, kAcross);
    row_count_ = blocks_over(height, kDown);
    const std::vector<double> squares =
        mean_squares({.count = columns_ * kAcross, .pixels = static_cast<std::size_t>(width)},
                     {.count = row_count_ * kDown, .pixels = static_cast<std::size_t>(height)}, squares_of_row);
    const auto cell_weights = [&](std::size_t block) {
        std::array<double, kCells> weights{};
        for (std::size_t i = 0; i < kCells; ++i) {
            const std::size_t row = block / columns_ * kDown + i / kAcross;
            weights[i] = std::sqrt(squares[(row * columns_ + block % columns_) * kAcross + i % kAcross]);
        }
        return weights;
    };
    // Of blocks as a whole and in cells. The root of ∫ f²/p is the sum of all weights.
    std::vector<double> weights;
    std::vector<double> in_cells;
    for (std::size_t block = 0; block < columns_ * row_count_; ++block) {
        const std::array<double, kCells> cells = cell_weights(block);
        weights.push_back(std::sqrt(std::inner_product(cells.begin(), cells.end(), cells.begin(), 0.0) / kCells));
        in_cells.push_back(std::min(std::accumulate(cells.begin(), cells.end(), 0.0) / kCells, weights.back()));
    }
    const auto add_cells = [&](const std::array<double, kCells>& of) {
        const std::vector<std::uint32_t> falls = chances(of, kChancesABlock);
        std::exclusive_scan(falls.begin(), falls.end(), cells_.emplace_back().begin(), 0U);
    };
    std::array<double, kCells> even{};
    even.fill(1.0);
    add_cells(even);
    blocks_.resize((columns_ + kAfter) * row_count_);
    for (const std::size_t block : worth_cells(weights, in_cells)) {
        blocks_[block / columns_ * (columns_ + kAfter) + block % columns_].cells =
            static_cast<std::uint16_t>(cells_.size());
        add_cells(cell_weights(block));
        weights[block] = in_cells[block];
    }
    std::vector<double> row_weights;
    for (std::size_t row = 0; row < row_count_; ++row) {
        const auto of_row = std::span(weights).subspan(row * columns_, columns_);
        fill(blocks_.data() + row * (columns_ + kAfter), of_row);
        row_weights.push_back(std::accumulate(of_row.begin(), of_row.end(), 0.0));
    }
    rows_.resize(row_count_ + kAfter);
    fill(rows_.data(), row_weights);
}

void PixelDistribution::fill(Step* steps, std::span<const double> weights) {
    const std::vector<std::uint32_t> falls = chances(weights, kChances);
    std::uint32_t before = 0;
    for (std::size_t i = 0; i < falls.size(); ++i) {
        steps[i].before = before;
        before += falls[i];
    }
    std::fill_n(steps + falls.size(), kAfter, Step{.before = kChances});
    std::size_t step = 0;
    for (std::size_t part = 0; part < falls.size(); ++part) {
        const double begin = double{kChances} * static_cast<double>(part) / static_cast<double>(falls.size());
        while (step + 1 < falls.size() && steps[step + 1].before <= begin) {
            ++step;
        }
        steps[part].guide = static_cast<std::uint16_t>(step);
    }
}

std::size_t PixelDistribution::part_at(std::size_t steps, double u) {
    return std::min(static_cast<std::size_t>(u * static_cast<double>(steps)), steps - 1);
}

double PixelDistribution::width_of(const Cells& sums, std::size_t cell) {
    return (cell + 1 < kCells ? sums[cell + 1] : kChancesABlock) - sums[cell];
}

PixelDistribution::Found PixelDistribution::find(const Step* steps, std::size_t count, double u) {
    const double at = kChances * u;  // below all of them
    const auto whole = static_cast<std::uint32_t>(at);
    const Step* step = steps + steps[part_at(count, u)].guide;
    // Three at a time, without asking: most often it is one of these, and as often any.
    for (int passed = kAfter; passed == kAfter; step += passed) {
        passed =
            (step[1].before <= whole ? 1 : 0) + (step[2].before <= whole ? 1 : 0) + (step[3].before <= whole ? 1 : 0);
    }
    const double width = width_of(step);
    return {.step = static_cast<std::size_t>(step - steps),
            .fraction = std::clamp((at - step->before) / width, 0.0, kBelowOne),
            .width = width};
}

PixelDistribution::Draw PixelDistribution::draw(const Vec2d& numbers) const {
    const Found row = find(rows_.data(), row_count_, numbers.x);
    return draw_in(row, find(blocks_of(row.step), columns_, numbers.y));
}

void PixelDistribution::draw(std::span<const Vec2d> numbers, std::span<Draw> draws) const {
    constexpr std::size_t kAhead = 16;
    std::array<Found, kAhead> rows;
    std::array<Found, kAhead> blocks;
    for (std::size_t begin = 0; begin < numbers.size(); begin += kAhead) {
        const std::size_t count = std::min(numbers.size() - begin, kAhead);
        for (std::size_t i = 0; i < count; ++i) {
            rows[i] = find(rows_.data(), row_count_, numbers[begin + i].x);
            __builtin_prefetch(blocks_of(rows[i].step) + part_at(columns_, numbers[begin + i].y));
        }
        for (std::size_t i = 0; i < count; ++i) {
            blocks[i] = find(blocks_of(rows[i].step), columns_, numbers[begin + i].y);
            __builtin_prefetch(&cells_of(rows[i].step, blocks[i].step));
        }
        for (std::size_t i = 0; i < count; ++i) {
            draws[begin + i] = draw_in(rows[i], blocks[i]);
        }
    }
}

PixelDistribution::Draw PixelDistribution::draw_in(const Found& row, const Found& block) const {
    const Cells& sums = cells_of(row.step, block.step);
    const double at = kChancesABlock * block.fraction;
    const auto whole = static_cast<std::uint16_t>(at);
    std::uint16_t reached = 0;  // one at least: nothing stands before the first
    for (std::size_t i = 0; i < kCells; ++i) {
        reached = static_cast<std::uint16_t>(reached + (sums[i] <= whole ? 1 : 0));
    }
    const std::size_t cell = std::size_t{reached} - 1;
    const double width = width_of(sums, cell);
    const double across = std::clamp((at - sums[cell]) / width, 0.0, kBelowOne);
    const double x = static_cast<double>(block.step * kAcross + cell % kAcross) + across;
    const std::size_t cell_row = row.step * kDown + cell / kAcross;
    const double y = static_cast<double>(cell_row) + row.fraction;
    return {.at = {x / static_cast<double>(columns_ * kAcross), y / static_cast<double>(row_count_ * kDown)},
            .pdf = density(row.width, block.width, width)};
}

PixelDistribution::Place PixelDistribution::place(const Vec2d& at) const {
    const std::size_t x = part_at(columns_ * kAcross, at.x);
    const std::size_t y = part_at(row_count_ * kDown, at.y);
    return {.row = y / kDown, .column = x / kAcross, .cell = y % kDown * kAcross + x % kAcross};
}

double PixelDistribution::pdf(const Place& place) const {
    return density(width_of(&rows_[place.row]), width_of(blocks_of(place.row) + place.column),
                   width_of(cells_of(place.row, place.column), place.cell));
}

double PixelDistribution::pdf(const Vec2d& at) const {
    return pdf(place(at));
}

void PixelDistribution::find_pdfs(std::span<const Vec2d> at, std::span<double> pdfs) const {
    constexpr std::size_t kAhead = 16;
    std::array<Place, kAhead> places;
    for (std::size_t begin = 0; begin < at.size(); begin += kAhead) {
        const std::size_t count = std::min(at.size() - begin, kAhead);
        for (std::size_t i = 0; i < count; ++i) {
            places[i] = place(at[begin + i]);
            __builtin_prefetch(blocks_of(places[i].row) + places[i].column);
        }
        for (std::size_t i = 0; i < count; ++i) {
            __builtin_prefetch(&cells_of(places[i].row, places[i].column));
        }
        for (std::size_t i = 0; i < count; ++i) {
            pdfs[begin + i] = pdf(places[i]);
        }
    }
}

double PixelDistribution::density(double row_width, double block_width, double cell_width) const {
    constexpr double kAll = double{kChances} * double{kChances} * double{kChancesABlock} / kCells;
    return row_width * block_width * cell_width * (static_cast<double>(columns_ * row_count_) / kAll);
}

}  // namespace lensproof::scene
