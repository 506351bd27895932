#include "engine/pupil/pupil_slices.h"

#include <algorithm>
#include <iterator>

#include "engine/base/gather.h"
#include "engine/base/infinity.h"

namespace lensproof::pupil {

namespace {

static_assert(PupilSliceTables::kPanels == kPupilPanels && PupilSliceTables::kAreaSteps == kGuideSteps &&
              PupilSliceTables::kRadiusSteps == kFinestFractions);

constexpr int kMostSlices = 256;  // of some 30 kB

double position_of(int slice, int slices) {
    return slices > 1 ? slice / (slices - 1.0) : 0.0;
}

}  // namespace

PupilSlices::PupilSlices(const PupilMap& map, int slices) : map_(map), slices_(slices) {
    const PupilNodes& nodes = map.regions().nodes();
    if (nodes.regions.empty() || nodes.azimuths > 1 || nodes.symmetry != PupilSymmetry::mirror ||
        slices > kMostSlices) {
        return;
    }
    const std::size_t count = nodes.fractions.size();
    for (std::size_t i = 0; i + 1 < count; ++i) {
        per_step_.push_back(1.0 / (nodes.fractions[i + 1] - nodes.fractions[i]));
    }
    std::int32_t below = 0;
    for (int i = 0; i <= PupilSliceTables::kRadiusSteps; ++i) {
        while (below + 2 < static_cast<std::int32_t>(count) &&
               nodes.fractions[below + 1] * PupilSliceTables::kRadiusSteps <= i) {
            ++below;
        }
        node_below_.push_back(below);
    }
    for (int slice = 0; slice < slices; ++slice) {
        add_slice(position_of(slice, slices));
    }
    panel_below_.insert(panel_below_.end(), kBytesBeyond, 0);
    const PupilFractions& fractions = pupil_fractions(nodes.symmetry);
    for (int i = 0; i <= PupilSliceTables::kWidthSteps; ++i) {
        const int panel = fractions.panel(static_cast<double>(i) / PupilSliceTables::kWidthSteps);
        panel_across_.push_back(panel);
        next_panel_.push_back(panel + 1 < kPupilPanels ? fractions.at[panel + 1] : kInfinity);
    }
    const Disc& disc = map.regions().disc();
    const double defensive_fraction = map.regions().defensive_fraction();
    tables_ = {.nodes = static_cast<int>(count),
               .per_end = per_end_.data(),
               .fractions = nodes.fractions.data(),
               .per_step = per_step_.data(),
               .node_below = node_below_.data(),
               .regions = regions_.data(),
               .panel_below = panel_below_.data(),
               .panel_fractions = fractions.at.data(),
               .panel_across = panel_across_.data(),
               .next_panel = next_panel_.data(),
               .per_panel = fractions.per_width.data(),
               .disc = disc,
               .disc_radius2 = disc.radius * disc.radius,
               .disc_pdf = defensive_fraction / disc.area(),
               .defensive_fraction = defensive_fraction,
               .per_other_fraction = 1.0 / (1.0 - defensive_fraction)};
}

void PupilSlices::add_slice(double position) {
    const PupilNodes& nodes = map_.regions().nodes();
    const std::vector<double>& positions = nodes.positions;
    std::size_t below = 0;
    while (below + 2 < positions.size() && positions[below + 1] < position) {
        ++below;
    }
    const std::size_t above = std::min(below + 1, positions.size() - 1);
    const double t = above > below
                         ? std::clamp((position - positions[below]) / (positions[above] - positions[below]), 0.0, 1.0)
                         : 0.0;
    per_end_.push_back(1.0 / ((1.0 - t) * nodes.ends[below] + t * nodes.ends[above]));
    std::vector<PanelGuide> guides;
    for (std::size_t i = 0; i < nodes.fractions.size(); ++i) {
        const PupilRegion region =
            mean_region(nodes.regions[nodes.index(below, 0, i)], nodes.regions[nodes.index(above, 0, i)], t);
        regions_.push_back(region.width);
        for (const PupilColumn& column : region.columns) {
            regions_.insert(regions_.end(), {column.lower, column.upper, column.area_before});
        }
        guides.push_back(panel_guide(region));
    }
    for (std::size_t i = 0; i < guides.size(); ++i) {
        std::ranges::transform(guides[i], guides[std::min(i + 1, guides.size() - 1)], std::back_inserter(panel_below_),
                               [](std::uint8_t a, std::uint8_t b) { return std::min(a, b); });
    }
}

PupilDraw<double> PupilSlices::sample(Vec2d sensor_point, int slice, double u, double v) const {
    if (tables() == nullptr) {
        const PupilSample sample = map_.sample(sensor_point, position_of(slice, slices_), u, v);
        return {sample.point, sample.pdf > 0.0 ? 1.0 / sample.pdf : 0.0};
    }
    return draw_pupil_point(tables_, slice, sensor_point, u, v);
}

double PupilSlices::pdf(Vec2d sensor_point, int slice, Vec2d pupil_point) const {
    if (tables() == nullptr) {
        return map_.pdf(sensor_point, position_of(slice, slices_), pupil_point);
    }
    return PupilSlice<double>(tables_, slice, sensor_point).pdf(pupil_point);
}

}  // namespace lensproof::pupil
