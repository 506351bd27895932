#include "engine/pupil/region_map.h"

#include <algorithm>
#include <array>
#include <utility>

namespace lensproof::pupil {

namespace {

constexpr double kBelowOne = 1.0 - 0x1p-53;

/// Calls use(region, guide) with the region at a lit place.
template <class Use>
auto with_region(const PupilNodes& nodes, const PupilGuides& guides, const PupilPlace& place, const Use& use) {
    const auto at = [&](std::size_t position, std::size_t azimuth) {
        return &nodes.regions[nodes.index(position, azimuth, place.fraction)];
    };
    const BetweenNodes& band = place.position;
    const double t = place.t;
    const std::array<double, 4> weights = {(1.0 - band.t) * (1.0 - t), (1.0 - band.t) * t, band.t * (1.0 - t),
                                           band.t * t};
    if (nodes.azimuths == 1) {
        const PupilRegion* below = at(band.below, 0);
        const PupilRegion* above = at(band.above, 0);
        return use(BlendedRegion<4>({below, below + 1, above, above + 1}, weights, nodes.symmetry),
                   guides.panels(nodes.index(band.below, 0, place.fraction)));
    }
    const BetweenNodes& turn = place.azimuth;
    std::array<const PupilRegion*, 8> regions{};
    std::array<double, 8> fractions{};
    for (std::size_t i = 0; i < weights.size(); ++i) {
        const std::size_t position = i < 2 ? band.below : band.above;
        regions[i] = at(position, turn.below) + i % 2;
        regions[i + 4] = at(position, turn.above) + i % 2;
        fractions[i] = (1.0 - turn.t) * weights[i];
        fractions[i + 4] = turn.t * weights[i];
    }
    return use(BlendedRegion<8>(regions, fractions, nodes.symmetry),
               guides.panels(nodes.index(band.below, turn.below, place.fraction)));
}

}  // namespace

RegionMap::RegionMap(const Disc& disc, double defensive_fraction, PupilNodes nodes)
    : disc_(disc), defensive_fraction_(defensive_fraction), nodes_(std::move(nodes)), guides_(nodes_) {}

PupilSample RegionMap::sample(Vec2d at, double band_position, double u, double v) const {
    const double disc_pdf = defensive_fraction_ / disc_.area();
    const PupilPlace place = guides_.place(nodes_, at, band_position);
    if (u < defensive_fraction_) {
        const Vec2d point = disc_.warped(u / defensive_fraction_, v);
        return {point, disc_pdf + region_pdf(place, point)};
    }
    if (!place.is_lit) {
        return {};
    }
    const double rest = std::min((u - defensive_fraction_) / (1.0 - defensive_fraction_), kBelowOne);
    return with_region(nodes_, guides_, place, [&](const auto& region, const PanelGuide& guide) {
        const double area = region.area();
        if (!(area > 0.0)) {
            return PupilSample{};
        }
        const Vec2d point = place.from_own(region.sample(rest, v, guide));
        return PupilSample{point, (1.0 - defensive_fraction_) / area + (disc_.contains(point) ? disc_pdf : 0.0)};
    });
}

double RegionMap::pdf(Vec2d at, double band_position, Vec2d point) const {
    const PupilPlace place = guides_.place(nodes_, at, band_position);
    return (disc_.contains(point) ? defensive_fraction_ / disc_.area() : 0.0) + region_pdf(place, point);
}

double RegionMap::region_pdf(const PupilPlace& place, Vec2d point) const {
    if (!place.is_lit) {
        return 0.0;
    }
    return with_region(nodes_, guides_, place, [&](const auto& region, const PanelGuide&) {
        const double area = region.area();
        return area > 0.0 && region.contains(place.to_own(point)) ? (1.0 - defensive_fraction_) / area : 0.0;
    });
}

double RegionMap::area(Vec2d at, double band_position) const {
    const PupilPlace place = guides_.place(nodes_, at, band_position);
    return place.is_lit ? with_region(nodes_, guides_, place,
                                      [](const auto& region, const PanelGuide&) { return region.area(); })
                        : 0.0;
}

}  // namespace lensproof::pupil
