// engine/pupil/pupil_stations.h — outlines of the regions that light passes, traced where they are asked for.
#pragma once
#include <functional>
#include <map>
#include <tuple>
#include <vector>

#include "engine/base/disc.h"
#include "engine/optics/device/device_trace.h"
#include "engine/pupil/pupil_outline.h"

namespace lensproof::pupil {

/// The rays whose passage makes the regions: one for each place and each point of the plane that the regions lie in. A
/// place is a point of the sensor (mm), or a direction of the scene (the field angle, rad, along its azimuth). Turned
/// about the axis together, place and point have the turned ray.
struct RayFamily {
    optics::Direction direction = optics::Direction::forward;
    std::function<Ray<double>(Vec2d place, Vec2d point)> ray;
};

/// A place, and which lens of a band it is seen through. Ordered along the radii.
struct StationPlace {
    std::size_t lens = 0;
    double azimuth = 0.0;  // in turns, from +y towards +x
    double radius = 0.0;

    friend bool operator<(const StationPlace& a, const StationPlace& b) {
        return std::tie(a.lens, a.azimuth, a.radius) < std::tie(b.lens, b.azimuth, b.radius);
    }
};

/// The regions that light passes, for a band of lenses, one a wavelength. Each is given in the frame in which its place
/// lies at (0, r), and inside the disc.
class PupilStations {
  public:
    /// `device`: that traces, or null. All outlive this.
    PupilStations(const std::vector<optics::TraceLens<double>>& band, const RayFamily& rays, const Disc& disc,
                  PupilSymmetry symmetry, device::SharedDevice* device)
        : band_(band), lens_(band), tracer_(lens_, device), rays_(rays), disc_(disc), symmetry_(symmetry) {}
    PupilStations(const PupilStations&) = delete;  // the tracer refers to the lens
    PupilStations& operator=(const PupilStations&) = delete;

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
    [[nodiscard]] Ray<double> ray(const StationPlace& place, Vec2d own_point) const;
    void ask(const std::vector<Request>& requests, std::span<const RegionPoint> points,
             std::span<std::uint8_t> answers);
    [[nodiscard]] std::optional<Vec2d> point_by_margin(const StationPlace& place) const;
    [[nodiscard]] std::optional<PupilFrame> expected_frame(const Request& request) const;

    const std::vector<optics::TraceLens<double>>& band_;
    optics::SpectralLens<double> lens_;  // the same
    optics::ColumnTracer<double> tracer_;
    const RayFamily& rays_;
    const Disc& disc_;
    PupilSymmetry symmetry_;
    std::map<StationPlace, PupilOutline> outlines_;
};

}  // namespace lensproof::pupil
