// engine/scene/chart/siemens_star.h — sectors that narrow to a point, for sharpness in every direction.
#pragma once
#include <cmath>
#include <numbers>
#include <string>

#include "engine/base/kinds.h"
#include "engine/scene/chart/chart_traits.h"
#include "engine/scene/chart/outline.h"

namespace lensproof::scene {

/// `sectors` sectors of equal angle, black and white in turn; the first black one begins at +x and runs towards +y.
struct SiemensStar {
    static constexpr KindNames<> kNames{"siemens-star"};
    int sectors = 0;  // even: twice the line pairs on a circle
    double radius_mm = 0.0;
};

void visit_keys(SiemensStar& star, auto& keys) {
    keys.whole("sectors", star.sectors, {.least = 2, .most = 10000, .printed = 72});
    keys.length("radius_mm", star.radius_mm, {2, 2});
    if (star.sectors % 2 != 0) {
        keys.refuse("sectors",
                    "is " + std::to_string(star.sectors) + ", expected an even number: black and white ones");
    }
}

inline bool is_black(const SiemensStar& star, double x_mm, double y_mm) {
    if (!(x_mm * x_mm + y_mm * y_mm < star.radius_mm * star.radius_mm)) {
        return false;
    }
    const double turn = std::atan2(y_mm, x_mm) / (2.0 * std::numbers::pi);
    return static_cast<int>((turn < 0.0 ? turn + 1.0 : turn) * star.sectors) % 2 == 0;
}

inline ChartTraits traits(const SiemensStar& star) {
    return {.points = {1, 1}, .size_mm = {2.0 * star.radius_mm, 2.0 * star.radius_mm}, .look = StarCentre()};
}

inline Outline outline(const SiemensStar& star) {
    Outline outline;
    const double sector = 2.0 * std::numbers::pi / star.sectors;
    for (int i = 0; i < star.sectors; i += 2) {
        outline.push_back({OutlineSector{star.radius_mm, i * sector, (i + 1) * sector}});
    }
    return outline;
}

}  // namespace lensproof::scene
