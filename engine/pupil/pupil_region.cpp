#include "engine/pupil/pupil_region.h"

#include <numbers>

namespace lensproof::pupil {

PupilFractions::PupilFractions(PupilSymmetry symmetry) {
    for (int i = 0; i <= kPupilPanels; ++i) {
        const double angle = std::numbers::pi * i / kPupilPanels;
        at[i] = symmetry == PupilSymmetry::mirror ? std::sin(0.5 * angle) : 0.5 * (1.0 - std::cos(angle));
    }
    for (std::size_t i = 0; i < per_width.size(); ++i) {
        per_width[i] = 1.0 / (at[i + 1] - at[i]);
    }
}

void PupilRegion::sum_areas(PupilSymmetry symmetry) {
    const auto& fractions = pupil_fractions(symmetry).at;
    columns[0].area_before = 0.0;
    for (std::size_t i = 0; i < kPupilPanels; ++i) {
        const double mean_height =
            0.5 * (columns[i].upper - columns[i].lower + columns[i + 1].upper - columns[i + 1].lower);
        columns[i + 1].area_before = columns[i].area_before + mean_height * (fractions[i + 1] - fractions[i]);
    }
}

PupilRegion mean_region(const PupilRegion& a, const PupilRegion& b, double t) {
    const auto between = [t](double from, double to) { return (1.0 - t) * from + t * to; };
    PupilRegion region{.left = between(a.left, b.left), .width = between(a.width, b.width)};
    for (std::size_t i = 0; i < region.columns.size(); ++i) {
        const PupilColumn& from = a.columns[i];
        const PupilColumn& to = b.columns[i];
        region.columns[i] = {.lower = between(from.lower, to.lower),
                             .upper = between(from.upper, to.upper),
                             .area_before = between(from.area_before, to.area_before)};
    }
    return region;
}

PanelGuide panel_guide(const PupilRegion& region) {
    PanelGuide guide{};
    int panel = 0;
    for (int i = 0; i < kGuideSteps; ++i) {
        const double target = region.columns.back().area_before * i / kGuideSteps;
        while (panel + 1 < kPupilPanels && region.columns[panel + 1].area_before <= target) {
            ++panel;
        }
        guide[i] = static_cast<std::uint8_t>(panel);
    }
    return guide;
}

}  // namespace lensproof::pupil
