// engine/pupil/pupil_map.h — from where on the rear element light reaches each point of the sensor.
#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/device/shared_device.h"
#include "engine/optics/trace.h"
#include "engine/pupil/rear_disc.h"
#include "engine/pupil/region_map.h"

namespace lensproof::pupil {

struct PupilMapSettings {
    /// The fraction of samples drawn over the whole rear element, whatever the map says: what the map missed costs
    /// noise then, and is not lost.
    double defensive_fraction = 0.003;
    /// Steps in radius, azimuth and wavelength are halved until regions between two nodes have to be enlarged by no
    /// more than this fraction of their area. Steps below 1/64 of the radius, where few points lie, may need more.
    double most_excess = 0.005;
    /// That traces rays, or null; the map is the same.
    device::SharedDevice* device = nullptr;
};

/// Draws paths' first points: for a point of the sensor, points of the pupil through which light may reach it, evenly
/// over a region that holds all of them and little else (after Steinert et al. 2011, "pixel pupil sampling").
///
/// Regions are found by tracing at nodes: wavelengths of a band, azimuths where the lens is not rotationally symmetric,
/// and radii on the sensor as fractions of the radius where the light ends. Between nodes they are linear in all three;
/// they hold the regions traced at the nodes and in the middles between them. In the frame of a region its sensor point
/// lies at (0, r), r ≥ 0. Blades and textures of the stop are taken for their full circle.
///
/// A fraction of the samples is drawn over the whole disc, so that nothing is lost however wrong a region is
/// (RegionMap).
class PupilMap {
  public:
    /// `band`: the lens at wavelengths that are spread evenly over the band. Sensor points lie within
    /// `sensor_radius_mm` of the axis. `by_radius`: the lens is rotationally symmetric, its stop's blades aside.
    PupilMap(const std::vector<optics::TraceLens<double>>& band, bool by_radius, double sensor_radius_mm,
             const PupilMapSettings& settings = {});

    /// The whole rear element for every sensor point: the baseline that maps are judged against.
    static PupilMap whole_element(const optics::TraceLens<double>& lens, double sensor_radius_mm);

    /// The point that (u, v) in the unit square maps to, x and y in lens space in the plane z = plane_z, and its
    /// pdf.
    [[nodiscard]] PupilSample sample(Vec2d sensor_point, double band_position, double u, double v) const {
        return regions_.sample(sensor_point, band_position, u, v);
    }

    /// The pdf that `sample` draws a point with, 1/mm²; 0 outside the disc and the region.
    [[nodiscard]] double pdf(Vec2d sensor_point, double band_position, Vec2d pupil_point) const {
        return regions_.pdf(sensor_point, band_position, pupil_point);
    }

    /// z of the plane that the points lie in.
    [[nodiscard]] double plane_z() const { return disc_.plane_z; }

    /// What every path crosses.
    [[nodiscard]] const RearDisc& disc() const { return disc_; }

    /// The area that is drawn from but for the defensive fraction, mm²; 0 where no light was found.
    [[nodiscard]] double region_area(Vec2d sensor_point, double band_position) const {
        return regions_.area(sensor_point, band_position);
    }

    [[nodiscard]] const RegionMap& regions() const { return regions_; }

    /// How many regions are stored.
    [[nodiscard]] std::size_t size() const { return regions_.nodes().regions.size(); }

    /// All of it as bytes, numbers as they lie in memory.
    [[nodiscard]] std::string serialized() const;
    /// Nothing where the bytes are not those of a map. Damage that leaves every number in its range is not seen.
    static std::optional<PupilMap> deserialized(std::string_view bytes);

  private:
    PupilMap(const RearDisc& disc, RegionMap regions);

    RearDisc disc_;
    RegionMap regions_;
};

}  // namespace lensproof::pupil
