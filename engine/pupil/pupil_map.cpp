#include "engine/pupil/pupil_map.h"

#include <cmath>
#include <utility>

#include "engine/base/bytes.h"
#include "engine/pupil/pupil_stations.h"

namespace lensproof::pupil {

namespace {

/// From points of the sensor outwards, through points of the disc's plane.
RayFamily rays_from_sensor(double image_z, double plane_z) {
    return {.direction = optics::Direction::reverse, .ray = [image_z, plane_z](Vec2d sensor_point, Vec2d pupil_point) {
                const Vec3d from{sensor_point.x, sensor_point.y, image_z};
                return optics::reverse_ray(from, Vec3d{pupil_point.x, pupil_point.y, plane_z});
            }};
}

RegionMap sensor_map(const std::vector<optics::TraceLens<double>>& band, const RearDisc& disc, bool by_radius,
                     double sensor_radius_mm, const PupilMapSettings& settings) {
    return {disc, settings.defensive_fraction,
            find_pupil_nodes(band, rays_from_sensor(band.front().image_z, disc.plane_z),
                             {.disc = disc,
                              .by_radius = by_radius,
                              .end = sensor_radius_mm,
                              .most_excess = settings.most_excess,
                              .device = settings.device})};
}

}  // namespace

PupilMap::PupilMap(const RearDisc& disc, RegionMap regions) : disc_(disc), regions_(std::move(regions)) {}

PupilMap::PupilMap(const std::vector<optics::TraceLens<double>>& band, bool by_radius, double sensor_radius_mm,
                   const PupilMapSettings& settings)
    : disc_(rear_disc(band.front(), sensor_radius_mm)),
      regions_(sensor_map(band, disc_, by_radius, sensor_radius_mm, settings)) {}

PupilMap PupilMap::whole_element(const optics::TraceLens<double>& lens, double sensor_radius_mm) {
    const RearDisc disc = rear_disc(lens, sensor_radius_mm);
    return {disc, RegionMap(disc, 1.0, {})};
}

std::string PupilMap::serialized() const {
    std::string bytes;
    append_bytes(bytes, disc_.plane_z);
    return bytes + regions_.serialized();
}

std::optional<PupilMap> PupilMap::deserialized(std::string_view bytes) {
    const std::optional<double> plane_z = take_bytes<double>(bytes);
    std::optional<RegionMap> regions = plane_z ? RegionMap::deserialized(bytes) : std::nullopt;
    if (!regions || !std::isfinite(*plane_z)) {
        return std::nullopt;
    }
    RearDisc disc;
    disc.radius = regions->disc().radius;
    disc.plane_z = *plane_z;
    return PupilMap(disc, std::move(*regions));
}

}  // namespace lensproof::pupil
