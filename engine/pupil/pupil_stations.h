// engine/pupil/pupil_stations.h — outlines of the regions that light passes, traced where they are asked for.
#pragma once
#include <map>
#include <tuple>
#include <vector>

#include "engine/optics/trace.h"
#include "engine/pupil/pupil_outline.h"
#include "engine/pupil/rear_disc.h"

namespace lensproof {

/// A point of the sensor, and which lens of a band it is seen through. Ordered along the radii.
struct StationPlace {
    std::size_t lens = 0;
    double azimuth = 0.0;  // as a share of a turn, from the sensor's +y towards +x
    double radius_mm = 0.0;

    friend bool operator<(const StationPlace& a, const StationPlace& b) {
        return std::tie(a.lens, a.azimuth, a.radius_mm) < std::tie(b.lens, b.azimuth, b.radius_mm);
    }
};

/// The regions of the rear disc's plane that light passes, for a band of lenses, one a wavelength. Each is given in the
/// frame in which its sensor point lies at (0, r).
class PupilStations {
  public:
    PupilStations(const std::vector<TraceLens<double>>& band, const RearDisc& disc, PupilSymmetry symmetry)
        : band_(band), disc_(disc), symmetry_(symmetry) {}

    /// A place to be traced, and others whose regions are much like its own, should it have no neighbours along the
    /// radius yet.
    struct Request {
        StationPlace place;
        std::vector<StationPlace> alike{};
    };

    /// Traces the outlines at the places that have none yet, all together.
    void trace(std::vector<Request> requests);

    /// Nothing where the place was not traced.
    [[nodiscard]] const PupilOutline* find(const StationPlace& place) const {
        const auto found = outlines_.find(place);
        return found == outlines_.end() ? nullptr : &found->second;
    }

  private:
    [[nodiscard]] Ray<double> ray(const StationPlace& place, Vec2d pupil_point) const;
    void ask(const std::vector<Request>& requests, std::span<const RegionPoint> points,
             std::span<std::uint8_t> answers) const;
    [[nodiscard]] std::optional<Vec2d> point_by_margin(const StationPlace& place) const;
    [[nodiscard]] std::optional<PupilFrame> expected_frame(const Request& request) const;

    const std::vector<TraceLens<double>>& band_;
    const RearDisc& disc_;
    PupilSymmetry symmetry_;
    std::map<StationPlace, PupilOutline> outlines_;
};

}  // namespace lensproof
