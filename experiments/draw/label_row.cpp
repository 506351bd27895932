#include "experiments/draw/label_row.h"

#include <algorithm>
#include <numeric>

namespace lensproof::draw {

namespace {

/// Labels that touch: the mean of where its start would be for each, and its width.
struct Block {
    double start = 0.0;
    double width = 0.0;
    std::size_t count = 0;
};

}  // namespace

std::vector<double> spread_labels(const std::vector<PlacedLabel>& labels, double left, double right) {
    const double total = std::accumulate(labels.begin(), labels.end(), 0.0,
                                         [](double sum, const PlacedLabel& label) { return sum + label.width; });
    const double squeeze = total > right - left ? std::max(0.0, right - left) / total : 1.0;
    std::vector<std::size_t> order(labels.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order, {}, [&](std::size_t i) { return labels[i].x; });

    std::vector<Block> blocks;
    const auto clamped = [&](double start, double width) { return std::max(left, std::min(start, right - width)); };
    for (const std::size_t i : order) {
        const double width = squeeze * labels[i].width;
        Block block{clamped(labels[i].x - 0.5 * width, width), width, 1};
        while (!blocks.empty() && blocks.back().start + blocks.back().width > block.start) {
            const Block& before = blocks.back();
            const auto n = static_cast<double>(before.count);
            const auto m = static_cast<double>(block.count);
            const double start = (n * before.start + m * (block.start - before.width)) / (n + m);
            const double joined = before.width + block.width;
            block = {clamped(start, joined), joined, before.count + block.count};
            blocks.pop_back();
        }
        blocks.push_back(block);
    }
    std::vector<double> middles(labels.size());
    auto next = order.begin();
    for (const Block& block : blocks) {
        double at = block.start;
        for (std::size_t k = 0; k < block.count; ++k, ++next) {
            const double width = squeeze * labels[*next].width;
            middles[*next] = at + 0.5 * width;
            at += width;
        }
    }
    return middles;
}

}  // namespace lensproof::draw
