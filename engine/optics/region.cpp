#include "engine/optics/region.h"

#include <algorithm>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <cstdint>

namespace lensproof::optics {

std::optional<Vec2d> find_inside(const Region& region, const RegionSearch& search) {
    Vec2d best = search.start;
    RegionSample least = region(best);
    const auto look = [&](Vec2d at) {
        const RegionSample here = region(at);
        if (here.margin < least.margin) {
            least = here;
            best = at;
            return true;
        }
        return false;
    };
    if (least.margin < 0.0) {
        return best;
    }
    const int rows = search.is_mirror ? 129 : 33;
    const int columns = search.is_mirror ? 1 : 33;
    double step = 2.0 * search.reach / (rows - 1);
    const int middle_column = columns / 2;
    const int middle_row = rows / 2;
    for (int i = -middle_column; i <= middle_column; ++i) {
        for (int k = -middle_row; k <= middle_row; ++k) {
            look(search.start + step * Vec2d{1.0 * i, 1.0 * k});
        }
    }
    // From the grid's step to the smallest are 27 halvings. At each, what is within a step of the floor of a valley n
    // times as long as it is wide moves some 2 n times along it; this is enough for n = 75. A margin that creeps on by
    // steps that are too small for it, as that of a rim of a nanometre does, is given up.
    constexpr double kSmallestStep = 1e-9;
    constexpr int kMostRounds = 4096;
    for (int round = 0; round < kMostRounds && !(least.margin < 0.0) && step > kSmallestStep * search.reach; ++round) {
        bool is_better = look(best + Vec2d{0.0, step}) || look(best - Vec2d{0.0, step});
        if (!search.is_mirror) {
            is_better = look(best + Vec2d{step, 0.0}) || look(best - Vec2d{step, 0.0}) || is_better;
        }
        if (!is_better) {
            step *= 0.5;
        }
    }
    return least.margin < 0.0 ? std::optional(best) : std::nullopt;
}

RegionEdge region_edge(const Region& region, Vec2d inside, Vec2d along, double hint) {
    const auto sample = [&](double distance) { return region(inside + distance * along); };
    double low = 0.0;
    double high = hint > 0.0 && std::isfinite(hint) ? hint : 1.0;
    RegionSample near = sample(low);
    RegionSample far = sample(high);
    constexpr double kStep = 1.3;  // a region without an edge is known for one after some 2700: 1.3²⁷⁰⁵ > 1.8e308
    while (far.margin <= 0.0 && std::isfinite(high)) {
        low = high;
        near = far;
        high *= kStep;
        far = sample(high);
    }
    const auto is_exact = [](double a, double b) { return b - a <= 1e-14 * b; };
    while (std::isinf(far.margin) && !is_exact(low, high)) {
        const double middle = 0.5 * (low + high);
        const RegionSample here = sample(middle);
        (here.margin <= 0.0 ? low : high) = middle;
        (here.margin <= 0.0 ? near : far) = here;
    }
    if (!(near.margin < 0.0) || is_exact(low, high)) {
        return {low, far.limit};
    }
    double nearest = high;
    const auto margin = [&](double distance) {
        const RegionSample here = sample(distance);
        if (here.margin > 0.0 && distance < nearest) {
            nearest = distance;
            far = here;
        }
        return std::min(here.margin, 1.0);  // an interpolation cannot use an infinite one
    };
    std::uintmax_t steps = 200;
    const auto root =
        boost::math::tools::toms748_solve(margin, low, high, near.margin, std::min(far.margin, 1.0), is_exact, steps);
    return {root.first, root.first == root.second ? sample(root.first).limit : far.limit};
}

}  // namespace lensproof::optics
