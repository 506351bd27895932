#include "engine/pupil/pupil_map.h"

#include <algorithm>
#include <array>

namespace lensproof {

namespace {

constexpr double kBelowOne = 1.0 - 0x1p-53;

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
    const auto at = [&](std::size_t position, std::size_t azimuth) {
        return &nodes.regions[nodes.index(position, azimuth, place.share)];
    };
    const BetweenNodes& band = place.position;
    const double t = place.t;
    const std::array<double, 4> weights = {(1.0 - band.t) * (1.0 - t), (1.0 - band.t) * t, band.t * (1.0 - t),
                                           band.t * t};
    if (nodes.azimuths == 1) {
        const PupilRegion* below = at(band.below, 0);
        const PupilRegion* above = at(band.above, 0);
        return use(BlendedRegion<4>({below, below + 1, above, above + 1}, weights, nodes.symmetry),
                   guides.panels(nodes.index(band.below, 0, place.share)));
    }
    const BetweenNodes turn = PupilGuides::azimuth(nodes, sensor_point);
    std::array<const PupilRegion*, 8> regions{};
    std::array<double, 8> shares{};
    for (std::size_t i = 0; i < weights.size(); ++i) {
        const std::size_t position = i < 2 ? band.below : band.above;
        regions[i] = at(position, turn.below) + i % 2;
        regions[i + 4] = at(position, turn.above) + i % 2;
        shares[i] = (1.0 - turn.t) * weights[i];
        shares[i + 4] = turn.t * weights[i];
    }
    return use(BlendedRegion<8>(regions, shares, nodes.symmetry),
               guides.panels(nodes.index(band.below, turn.below, place.share)));
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

PupilSample PupilMap::sample(Vec2d sensor_point, double band_position, double u, double v) const {
    const double disc_density = defensive_share_ / disc_.area();
    const PupilPlace place = guides_.place(nodes_, sensor_point, band_position);
    if (u < defensive_share_) {
        const Vec2d point = disc_.warped(u / defensive_share_, v);
        return {point, disc_density + region_density(place, sensor_point, point)};
    }
    if (!place.is_lit) {
        return {};
    }
    const double rest = std::min((u - defensive_share_) / (1.0 - defensive_share_), kBelowOne);
    return with_region(nodes_, guides_, place, sensor_point, [&](const auto& region, const PanelGuide& guide) {
        const double area = region.area();
        if (!(area > 0.0)) {
            return PupilSample{};
        }
        const Vec2d point = place.from_own(region.sample(rest, v, guide));
        return PupilSample{point, (1.0 - defensive_share_) / area + (disc_.contains(point) ? disc_density : 0.0)};
    });
}

double PupilMap::density(Vec2d sensor_point, double band_position, Vec2d pupil_point) const {
    const PupilPlace place = guides_.place(nodes_, sensor_point, band_position);
    return (disc_.contains(pupil_point) ? defensive_share_ / disc_.area() : 0.0) +
           region_density(place, sensor_point, pupil_point);
}

double PupilMap::region_density(const PupilPlace& place, Vec2d sensor_point, Vec2d pupil_point) const {
    if (!place.is_lit) {
        return 0.0;
    }
    return with_region(nodes_, guides_, place, sensor_point, [&](const auto& region, const PanelGuide&) {
        const double area = region.area();
        return area > 0.0 && region.contains(place.to_own(pupil_point)) ? (1.0 - defensive_share_) / area : 0.0;
    });
}

double PupilMap::region_area(Vec2d sensor_point, double band_position) const {
    const PupilPlace place = guides_.place(nodes_, sensor_point, band_position);
    return place.is_lit ? with_region(nodes_, guides_, place, sensor_point,
                                      [](const auto& region, const PanelGuide&) { return region.area(); })
                        : 0.0;
}

}  // namespace lensproof
