#include "engine/scene/light/pixel_distribution.h"

#include <algorithm>
#include <numeric>

namespace lensproof::scene {

namespace {

constexpr double kWhole = 0x1p32;

/// A guide for every cache line of sums.
constexpr std::size_t kStepsAGuide = 16;

std::size_t guide_cells(std::size_t steps) {
    return std::max(std::size_t{1}, steps / kStepsAGuide);
}

/// What lies before each step, of 2³² in all; a step that weighs anything has one of them before the rest goes by
/// weight, and what rounding leaves is the last step's.
template <class Weight>
void fill_sums(std::span<const Weight> weights, std::span<std::uint32_t> sums) {
    const double total = std::accumulate(weights.begin(), weights.end(), 0.0);
    const auto is_lit = [](Weight weight) { return weight > Weight(0); };
    const auto lit = static_cast<double>(std::count_if(weights.begin(), weights.end(), is_lit));
    const double shared = kWhole - 1.0 - lit;
    std::uint32_t lit_before = 0;
    double before = 0.0;
    for (std::size_t i = 0; i < weights.size(); ++i) {
        const double share = total > 0.0 ? std::min(before / total, 1.0) : 0.0;
        sums[i] = lit_before + static_cast<std::uint32_t>(share * shared);
        before += weights[i];
        lit_before += is_lit(weights[i]) ? 1U : 0U;
    }
}

/// For each cell of equal width the step that it begins in, and the last step behind them.
void fill_guides(std::span<const std::uint32_t> sums, std::span<std::uint32_t> guides) {
    const auto last = static_cast<std::uint32_t>(sums.size() - 1);
    std::uint32_t step = 0;
    for (std::size_t cell = 0; cell + 1 < guides.size(); ++cell) {
        const double begin = kWhole * static_cast<double>(cell) / static_cast<double>(guides.size() - 1);
        while (step < last && sums[step + 1] <= begin) {
            ++step;
        }
        guides[cell] = step;
    }
    guides.back() = last;
}

double width_of(std::span<const std::uint32_t> sums, std::size_t step) {
    return (step + 1 < sums.size() ? sums[step + 1] : kWhole) - sums[step];
}

struct Step {
    std::size_t index = 0;
    double fraction = 0.0;
    double width = 0.0;
};

std::size_t guide_at(std::span<const std::uint32_t> guides, double u) {
    const auto cells = static_cast<double>(guides.size() - 1);
    return static_cast<std::size_t>(std::clamp(u * cells, 0.0, cells - 1.0));
}

/// Searched for without branches, which no processor could foresee: each step halves what is left between two guides.
Step step_at(std::span<const std::uint32_t> sums, std::span<const std::uint32_t> guides, double u) {
    const std::size_t cell = guide_at(guides, u);
    const double at = kWhole * std::min(u, 1.0 - 0x1p-53);
    const auto whole = static_cast<std::uint32_t>(at);
    std::size_t index = guides[cell];
    for (std::size_t left = guides[cell + 1] - index; left > 0; left /= 2) {
        const std::size_t half = (left + 1) / 2;
        index += sums[index + half] <= whole ? half : 0;
    }
    const double width = width_of(sums, index);
    return {.index = index, .fraction = std::clamp((at - sums[index]) / width, 0.0, 1.0), .width = width};
}

}  // namespace

PixelDistribution::PixelDistribution(int width, const std::vector<float>& weights,
                                     const std::vector<double>& row_factors)
    : width_(static_cast<std::size_t>(width)), rows_(row_factors.size()), pixels_(weights.size()) {
    pixel_guides_.resize(height() * (guide_cells(width_) + 1));
    const std::size_t guides = pixel_guides_.size() / height();
    std::vector<double> row_weights;
    for (std::size_t row = 0; row < height(); ++row) {
        const std::span<const float> of_row = std::span(weights).subspan(row * width_, width_);
        const std::span<std::uint32_t> sums = std::span(pixels_).subspan(row * width_, width_);
        fill_sums(of_row, sums);
        fill_guides(sums, std::span(pixel_guides_).subspan(row * guides, guides));
        row_weights.push_back(row_factors[row] * std::accumulate(of_row.begin(), of_row.end(), 0.0));
    }
    fill_sums<double>(row_weights, rows_);
    row_guides_.resize(guide_cells(height()) + 1);
    fill_guides(rows_, row_guides_);
}

PixelDistribution::Draw PixelDistribution::draw(double u1, double u2) const {
    const Step row = step_at(rows_, row_guides_, u1);
    const Step pixel = step_at(pixels_of(row.index), guides_of(row.index), u2);
    return {.column = pixel.index,
            .row = row.index,
            .x = (static_cast<double>(pixel.index) + pixel.fraction) / static_cast<double>(width_),
            .y = (static_cast<double>(row.index) + row.fraction) / static_cast<double>(height()),
            .probability = row.width * pixel.width * 0x1p-64};
}

void PixelDistribution::expect(double u1, double u2) const {
    const std::size_t row = step_at(rows_, row_guides_, u1).index;
    const std::span<const std::uint32_t> guides = guides_of(row);
    const std::size_t cell = guide_at(guides, u2);
    const std::span<const std::uint32_t> sums = pixels_of(row);
    __builtin_prefetch(&sums[guides[cell]]);
    __builtin_prefetch(&sums[guides[cell + 1]]);
}

double PixelDistribution::probability(std::size_t column, std::size_t row) const {
    return width_of(rows_, row) * width_of(pixels_of(row), column) * 0x1p-64;
}

}  // namespace lensproof::scene
