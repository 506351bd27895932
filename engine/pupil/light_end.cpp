#include "engine/pupil/light_end.h"

#include <algorithm>

namespace lensproof::pupil {

namespace {

constexpr int kFirstRadii = 16;

/// Between which radii the light ends.
struct RadiusBracket {
    StationPlace place;  // its radius is of no account
    double lit;
    double dark;

    [[nodiscard]] double middle() const { return 0.5 * (lit + dark); }
};

StationPlace at_radius(StationPlace place, double radius) {
    place.radius = radius;
    return place;
}

bool is_lit(const PupilStations& stations, const StationPlace& place) {
    const PupilOutline* outline = stations.find(place);
    return outline != nullptr && !outline->is_empty();
}

}  // namespace

std::vector<double> light_ends(PupilStations& stations, const std::vector<std::size_t>& lenses,
                               const LightEndSearch& search) {
    const auto radius = [&](int i) { return search.farthest * i / kFirstRadii; };
    std::vector<RadiusBracket> brackets;
    std::vector<PupilStations::Request> requests;
    for (const std::size_t lens : lenses) {
        for (const double azimuth : search.azimuths) {
            brackets.push_back({.place = {lens, azimuth, 0.0}, .lit = 0.0, .dark = radius(1)});
        }
    }
    for (const RadiusBracket& bracket : brackets) {
        for (int i = 0; i <= kFirstRadii; ++i) {
            requests.push_back({.place = at_radius(bracket.place, radius(i)),
                                .alike = {at_radius(brackets.front().place, radius(i))}});
        }
        if (&bracket == &brackets.front()) {
            stations.trace(requests);  // what the others are likened to
        }
    }
    stations.trace(requests);
    for (RadiusBracket& bracket : brackets) {
        for (int i = 0; i <= kFirstRadii; ++i) {
            if (is_lit(stations, at_radius(bracket.place, radius(i)))) {
                bracket.lit = radius(i);
                bracket.dark = radius(std::min(i + 1, kFirstRadii));
            }
        }
    }
    for (double step = 1.0 / kFirstRadii; step > search.precision; step *= 0.5) {
        requests.clear();
        for (const RadiusBracket& bracket : brackets) {
            requests.push_back({.place = at_radius(bracket.place, bracket.middle())});
        }
        stations.trace(requests);
        for (RadiusBracket& bracket : brackets) {
            const double middle = bracket.middle();
            (is_lit(stations, at_radius(bracket.place, middle)) ? bracket.lit : bracket.dark) = middle;
        }
    }
    std::vector<double> ends;
    std::ranges::transform(brackets, std::back_inserter(ends), &RadiusBracket::lit);
    return ends;
}

}  // namespace lensproof::pupil
