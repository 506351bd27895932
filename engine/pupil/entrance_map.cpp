#include "engine/pupil/entrance_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "engine/base/angle.h"
#include "engine/base/bytes.h"
#include "engine/pupil/pupil_nodes.h"

namespace lensproof::pupil {

namespace {

constexpr double kWidestAngle = radians(160.0);

/// A direction as a place: its field angle along its azimuth.
Vec2d place_of(const Vec3d& direction) {
    const double from_axis = std::hypot(direction.x, direction.y);
    const double scale = from_axis > 0.0 ? std::atan2(from_axis, direction.z) / from_axis : 0.0;
    return {scale * direction.x, scale * direction.y};
}

Vec3d direction_of(Vec2d place) {
    const double angle = length(place);
    const double scale = angle > 0.0 ? std::sin(angle) / angle : 0.0;
    return {scale * place.x, scale * place.y, std::cos(angle)};
}

RayFamily rays_of_directions(const BoundingSphere& front, double distance_mm) {
    return {.direction = optics::Direction::forward, .ray = [front, distance_mm](Vec2d place, Vec2d offset) {
                return beam_along(front, direction_of(place), distance_mm).ray(offset);
            }};
}

RegionMap direction_map(const std::vector<optics::TraceLens<double>>& band, const BoundingSphere& front, bool by_angle,
                        double distance_mm, const PupilMapSettings& settings) {
    const NodeSearch search{.disc = {beam_along(front, {0.0, 0.0, 1.0}, distance_mm).radius},
                            .by_radius = by_angle,
                            .end = kWidestAngle,
                            .most_excess = settings.most_excess,
                            .device = settings.device};
    return {search.disc, settings.defensive_fraction,
            find_pupil_nodes(band, rays_of_directions(front, distance_mm), search)};
}

}  // namespace

EntranceMap::EntranceMap(const BoundingSphere& front, double distance_mm, RegionMap regions)
    : front_(front), distance_mm_(distance_mm), regions_(std::move(regions)) {}

EntranceMap::EntranceMap(const std::vector<optics::TraceLens<double>>& band, bool by_angle, double distance_mm,
                         const PupilMapSettings& settings)
    : front_(front_sphere(band.front())),
      distance_mm_(distance_mm),
      regions_(direction_map(band, front_, by_angle, distance_mm, settings)) {}

EntranceMap EntranceMap::whole_element(const optics::TraceLens<double>& lens, double distance_mm) {
    const BoundingSphere front = front_sphere(lens);
    const EntranceBeam beam = beam_along(front, {0.0, 0.0, 1.0}, distance_mm);
    return {front, distance_mm, RegionMap({beam.radius}, 1.0, {})};
}

EntranceBeam EntranceMap::beam(const Vec3d& direction) const {
    return beam_along(front_, direction, distance_mm_);
}

EntranceSample EntranceMap::sample(const EntranceBeam& beam, double band_position, double u, double v) const {
    const PupilSample drawn = regions_.sample(place_of(beam.axis.direction), band_position, u, v);
    return {.ray = beam.ray(drawn.point), .offset = drawn.point, .pdf = drawn.pdf};
}

void EntranceMap::pdfs(const EntranceBeam& beam, std::span<const double> band_positions, Vec2d offset,
                       std::span<double> found) const {
    const Vec2d place = place_of(beam.axis.direction);
    std::ranges::transform(band_positions, found.begin(),
                           [&](double position) { return regions_.pdf(place, position, offset); });
}

double EntranceMap::region_area(const EntranceBeam& beam, double band_position) const {
    return regions_.area(place_of(beam.axis.direction), band_position);
}

double EntranceMap::largest_angle() const {
    const std::vector<double>& ends = regions_.nodes().ends;
    return ends.empty() ? 0.0 : std::ranges::max(ends);
}

std::string EntranceMap::serialized() const {
    std::string bytes;
    append_bytes(bytes, front_.centre.x, front_.centre.y, front_.centre.z, front_.radius, distance_mm_);
    return bytes + regions_.serialized();
}

std::optional<EntranceMap> EntranceMap::deserialized(std::string_view bytes) {
    std::array<double, 5> numbers{};
    for (double& number : numbers) {
        const std::optional<double> taken = take_bytes<double>(bytes);
        if (!taken || std::isnan(*taken)) {
            return std::nullopt;
        }
        number = *taken;
    }
    const auto& [x, y, z, radius, distance_mm] = numbers;
    const bool is_sound =
        std::isfinite(x) && std::isfinite(y) && std::isfinite(z) && radius > 0.0 && distance_mm > radius;
    std::optional<RegionMap> regions = is_sound ? RegionMap::deserialized(bytes) : std::nullopt;
    return regions ? std::optional(EntranceMap({{x, y, z}, radius}, distance_mm, *std::move(regions))) : std::nullopt;
}

}  // namespace lensproof::pupil
