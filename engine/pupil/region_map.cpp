#include "engine/pupil/region_map.h"

#include <array>
#include <utility>

namespace lensproof {

namespace {

/// Calls use(region, guide) with the region at a lit place.
template <class Use>
auto with_region(const PupilNodes& nodes, const PupilGuides& guides, const PupilPlace& place, Vec2d at,
                 const Use& use) {
    const PupilRegion* inner = &nodes.regions[place.radius * nodes.azimuths];
    const PupilRegion* outer = inner + nodes.azimuths;
    if (nodes.azimuths == 1) {
        return use(BlendedRegion<2>({inner, outer}, {1.0 - place.t, place.t}, nodes.symmetry),
                   guides.panels(place.radius));
    }
    const AzimuthPlace azimuth = PupilGuides::azimuth_place(nodes, at);
    const double s = azimuth.t;
    const double t = place.t;
    return use(
        BlendedRegion<4>({inner + azimuth.below, inner + azimuth.above, outer + azimuth.below, outer + azimuth.above},
                         {(1.0 - t) * (1.0 - s), (1.0 - t) * s, t * (1.0 - s), t * s}, nodes.symmetry),
        guides.panels(place.radius * nodes.azimuths + azimuth.below));
}

}  // namespace

RegionMap::RegionMap(const Disc& disc, double defensive_share, PupilNodes nodes)
    : disc_(disc), defensive_share_(defensive_share), nodes_(std::move(nodes)), guides_(nodes_) {}

PupilSample RegionMap::sample(Vec2d at, double u, double v) const {
    const double over_disc = 1.0 / disc_.area();
    const PupilPlace place = guides_.place(nodes_, at);
    if (!place.is_lit) {
        return {disc_.warped(u, v), over_disc};
    }
    return with_region(nodes_, guides_, place, at, [&](const auto& region, const PanelGuide& guide) -> PupilSample {
        const double area = region.area();
        if (!(area > 0.0)) {
            return {disc_.warped(u, v), over_disc};
        }
        const double over_region = (1.0 - defensive_share_) / area;
        if (u < defensive_share_) {
            const Vec2d point = disc_.warped(u / defensive_share_, v);
            const bool is_inside = region.contains(place.to_own(point));
            return {point, defensive_share_ * over_disc + (is_inside ? over_region : 0.0)};
        }
        const Vec2d own = region.sample((u - defensive_share_) / (1.0 - defensive_share_), v, guide);
        const Vec2d point = place.from_own(own);
        return {point, over_region + (disc_.contains(point) ? defensive_share_ * over_disc : 0.0)};
    });
}

double RegionMap::density(Vec2d at, Vec2d point) const {
    const double over_disc = disc_.contains(point) ? 1.0 / disc_.area() : 0.0;
    const PupilPlace place = guides_.place(nodes_, at);
    if (!place.is_lit) {
        return over_disc;
    }
    return with_region(nodes_, guides_, place, at, [&](const auto& region, const PanelGuide&) {
        const double area = region.area();
        if (!(area > 0.0)) {
            return over_disc;
        }
        const bool is_inside = region.contains(place.to_own(point));
        return defensive_share_ * over_disc + (is_inside ? (1.0 - defensive_share_) / area : 0.0);
    });
}

double RegionMap::area(Vec2d at) const {
    const PupilPlace place = guides_.place(nodes_, at);
    return place.is_lit ? with_region(nodes_, guides_, place, at,
                                      [](const auto& region, const PanelGuide&) { return region.area(); })
                        : 0.0;
}

}  // namespace lensproof
