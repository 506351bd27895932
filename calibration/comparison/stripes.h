// calibration/comparison/stripes.h — a picture's rows in stripes, so that what a filter needs in between stays small.
#pragma once
#include <algorithm>

#include "engine/base/parallel.h"

namespace lensproof::calibration {

/// Rows [first, last) of a picture, and those around them that a filter reaches, [padded_first, padded_last).
struct Stripe {
    int first = 0;
    int last = 0;
    int padded_first = 0;
    int padded_last = 0;
};

/// Calls work(stripe) for all stripes of the picture, on several threads (0: one a core).
template <class Work>
void for_stripes(int height, int reach, int threads, const Work& work) {
    const int rows = std::max(64, 2 * reach);
    parallel_for((height + rows - 1) / rows, threads, [&](int i) {
        const int first = i * rows;
        const int last = std::min(height, first + rows);
        work(Stripe{.first = first,
                    .last = last,
                    .padded_first = std::max(0, first - reach),
                    .padded_last = std::min(height, last + reach)});
    });
}

}  // namespace lensproof::calibration
