#include "engine/pupil/pupil_map.h"

#include <algorithm>
#include <array>

namespace lensproof {

namespace {

/// The band with its stops opened to the full circle, which holds what any blades leave.
std::vector<TraceLens<double>> with_round_stops(std::vector<TraceLens<double>> band) {
    for (TraceLens<double>& lens : band) {
        for (SpecialSurface<double>& special : lens.specials) {
            special.mask = {};
        }
    }
    return band;
}

/// Calls use(region, guide) with the region at a lit place.
template <class Use>
auto with_region(const PupilNodes& nodes, const PupilGuides& guides, const PupilPlace& place, Vec2d sensor_point,
                 const Use& use) {
    const PupilRegion* inner = &nodes.regions[place.radius * nodes.azimuths];
    const PupilRegion* outer = inner + nodes.azimuths;
    if (nodes.azimuths == 1) {
        return use(BlendedRegion<2>({inner, outer}, {1.0 - place.t, place.t}, nodes.symmetry),
                   guides.panels(place.radius));
    }
    const AzimuthPlace azimuth = PupilGuides::azimuth_place(nodes, sensor_point);
    const double s = azimuth.t;
    const double t = place.t;
    return use(
        BlendedRegion<4>({inner + azimuth.below, inner + azimuth.above, outer + azimuth.below, outer + azimuth.above},
                         {(1.0 - t) * (1.0 - s), (1.0 - t) * s, t * (1.0 - s), t * s}, nodes.symmetry),
        guides.panels(place.radius * nodes.azimuths + azimuth.below));
}

}  // namespace

PupilMap::PupilMap(const RearDisc& disc, double defensive_share, PupilNodes nodes)
    : disc_(disc), defensive_share_(defensive_share), nodes_(std::move(nodes)), guides_(nodes_) {}

PupilMap::PupilMap(const std::vector<TraceLens<double>>& band, bool by_radius, double sensor_radius_mm,
                   const PupilMapSettings& settings)
    : disc_(rear_disc(band.front(), sensor_radius_mm)), defensive_share_(settings.defensive_share) {
    nodes_ = find_pupil_nodes(
        with_round_stops(band), disc_,
        {.by_radius = by_radius, .sensor_radius_mm = sensor_radius_mm, .most_excess = settings.most_excess});
    guides_ = PupilGuides(nodes_);
}

PupilMap PupilMap::whole_element(const TraceLens<double>& lens, double sensor_radius_mm) {
    return {rear_disc(lens, sensor_radius_mm), 1.0, {}};
}

PupilSample PupilMap::sample(Vec2d sensor_point, double u, double v) const {
    const double over_disc = 1.0 / disc_.area();
    const PupilPlace place = guides_.place(nodes_, sensor_point);
    if (!place.is_lit) {
        return {disc_.warped(u, v), over_disc};
    }
    return with_region(nodes_, guides_, place, sensor_point,
                       [&](const auto& region, const PanelGuide& guide) -> PupilSample {
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

double PupilMap::density(Vec2d sensor_point, Vec2d pupil_point) const {
    const double over_disc = disc_.contains(pupil_point) ? 1.0 / disc_.area() : 0.0;
    const PupilPlace place = guides_.place(nodes_, sensor_point);
    if (!place.is_lit) {
        return over_disc;
    }
    return with_region(nodes_, guides_, place, sensor_point, [&](const auto& region, const PanelGuide&) {
        const double area = region.area();
        if (!(area > 0.0)) {
            return over_disc;
        }
        const bool is_inside = region.contains(place.to_own(pupil_point));
        return defensive_share_ * over_disc + (is_inside ? (1.0 - defensive_share_) / area : 0.0);
    });
}

double PupilMap::region_area(Vec2d sensor_point) const {
    const PupilPlace place = guides_.place(nodes_, sensor_point);
    return place.is_lit ? with_region(nodes_, guides_, place, sensor_point,
                                      [](const auto& region, const PanelGuide&) { return region.area(); })
                        : 0.0;
}

}  // namespace lensproof
