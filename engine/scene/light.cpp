#include "engine/scene/light.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "engine/base/basis.h"
#include "engine/base/overloaded.h"
#include "engine/scene/bsdf/directions.h"

namespace lensproof::scene {

namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kSquareMetresPerSquareMm = 1e-6;

double mean_of(const spectral::GridSpectrum& spectrum) {
    return std::accumulate(spectrum.value.begin(), spectrum.value.end(), 0.0) /
           static_cast<double>(spectrum.value.size());
}

/// Solid angle of a cone about an axis.
double cone(double cos_half_angle) {
    return 2.0 * kPi * (1.0 - cos_half_angle);
}

/// A direction of a cone about z, evenly.
Vec3d in_cone(double cos_half_angle, double u1, double u2) {
    const double down = u1 * (1.0 - cos_half_angle);  // 1 − z, which does not cancel in a narrow cone
    const double across = std::sqrt(down * (2.0 - down));
    const double angle = 2.0 * kPi * u2;
    return {across * std::cos(angle), across * std::sin(angle), 1.0 - down};
}

/// A point of the disc of radius 1, evenly.
Vec2d in_disc(double u1, double u2) {
    const double radius = std::sqrt(u1);
    return {radius * std::cos(2.0 * kPi * u2), radius * std::sin(2.0 * kPi * u2)};
}

/// The share of its full intensity that a spot has `cosine` off its axis.
double spot_falloff(const SpotLight& spot, double cosine) {
    if (cosine >= spot.cos_inner) {
        return 1.0;
    }
    if (cosine <= spot.cos_outer) {
        return 0.0;
    }
    const double t = (cosine - spot.cos_outer) / (spot.cos_inner - spot.cos_outer);
    return t * t * (3.0 - 2.0 * t);
}

bool is_at_infinity(const LightSource& light) {
    return std::holds_alternative<SunLight>(light) || std::holds_alternative<ConstantLight>(light) ||
           std::holds_alternative<EnvironmentLight>(light);
}

spectral::SpectralSample scaled(const spectral::SpectralSample& sample, double scale) {
    return static_cast<float>(scale) * sample;
}

/// A cosine about the normal, from each of the sides that shine with the density of a point there.
double leaving_surface(const AreaLight& area, double per_mm2) {
    return per_mm2 / ((area.is_two_sided ? 2.0 : 1.0) * kPi);
}

/// `cone`: the solid angle that light paths leave the point in.
std::optional<LightSample> from_point(const Vec3d& position, const spectral::SpectralSample& intensity,
                                      const Vec3d& seen_from, double cone) {
    const Vec3d way = position - seen_from;
    const double distance2 = dot(way, way);
    if (!(distance2 > 0.0)) {
        return {};
    }
    return LightSample{.direction = normalized(way),
                       .end = position,
                       .value = scaled(intensity, 1.0 / (distance2 * kSquareMetresPerSquareMm)),
                       .leaving_per_sample = 1.0 / (cone * distance2)};
}

/// The cone under which a point outside sees a ball: 1 − the cosine of its half-angle, without cancelling.
double one_minus_cosine(double radius_mm, double distance2) {
    const double sine2 = radius_mm * radius_mm / distance2;
    return sine2 / (1.0 + std::sqrt(1.0 - sine2));
}

}  // namespace

Lights::Lights(const SceneGeometry& scene, std::vector<LightSource> lights) : of_object_(scene.object_count(), -1) {
    const Box& box = scene.bounds();
    centre_ = 0.5 * (box.low + box.high);
    radius_mm_ = 0.5 * length(box.high - box.low);
    const double cross_section = kPi * radius_mm_ * radius_mm_ * kSquareMetresPerSquareMm;
    crossing_density_ = radius_mm_ > 0.0 ? 1.0 / (kPi * radius_mm_ * radius_mm_) : 0.0;
    std::vector<double> powers;
    for (LightSource& light : lights) {
        std::optional<SurfaceSampler> surface;
        const auto index = static_cast<std::uint32_t>(lights_.size());
        const double power = std::visit(
            Overloaded{
                [&](const AreaLight& area) {
                    surface.emplace(scene, area.object);
                    of_object_[area.object] = static_cast<std::int32_t>(index);
                    return (area.is_two_sided ? 2.0 : 1.0) * kPi * mean_of(area.radiance) * surface->area_mm2() *
                           kSquareMetresPerSquareMm;
                },
                [](const PointLight& point) { return 4.0 * kPi * mean_of(point.intensity); },
                [](const SpotLight& spot) {
                    // A smoothstep's mean is 1/2.
                    return 0.5 * (cone(spot.cos_inner) + cone(spot.cos_outer)) * mean_of(spot.intensity);
                },
                [&](const SunLight& sun) { return mean_of(sun.radiance) * cone(sun.cos_radius) * cross_section; },
                [&](const ConstantLight& sky) { return mean_of(sky.radiance) * 4.0 * kPi * cross_section; },
                [&](const EnvironmentLight& sky) { return sky.map->mean_power() * cross_section; }},
            light);
        std::optional<Ball> ball;
        if (const auto* area = std::get_if<AreaLight>(&light); area != nullptr && !area->is_two_sided) {
            ball = ball_of(scene, area->object);
        }
        if (is_at_infinity(light)) {
            at_infinity_.push_back(index);
        }
        lights_.push_back({.light = std::move(light), .surface = std::move(surface), .ball = ball});
        powers.push_back(power);
    }
    power_ = std::accumulate(powers.begin(), powers.end(), 0.0);
    double sum = 0.0;
    for (std::size_t i = 0; i < lights_.size(); ++i) {
        // Lights without power in the grid's band are never drawn, unless there are no others.
        lights_[i].probability = power_ > 0.0 ? powers[i] / power_ : 1.0 / static_cast<double>(lights_.size());
        cumulative_.push_back(sum += lights_[i].probability);
    }
}

Lights::Chosen Lights::choose(double u) const {
    const double target = u * cumulative_.back();
    const auto after = std::ranges::upper_bound(cumulative_, target);
    const std::size_t at = std::min(static_cast<std::size_t>(after - cumulative_.begin()), lights_.size() - 1);
    const double before = at > 0 ? cumulative_[at - 1] : 0.0;
    const double rest = (target - before) / (cumulative_[at] - before);
    return {&lights_[at], std::clamp(rest, 0.0, 1.0 - 0x1p-53)};
}

std::optional<Lights::Ball> Lights::ball_of(const SceneGeometry& scene, std::uint32_t object) {
    const auto* sphere = std::get_if<Sphere>(&scene.shape(object));
    const AffineMap& map = scene.object(object).to_world;
    const Vec3d stretches = principal_stretches(map.linear);
    if (sphere == nullptr || stretches.x - stretches.z > 1e-12 * stretches.x) {
        return {};
    }
    return Ball{map.translation, stretches.x * sphere->radius_mm};
}

std::optional<LightSample> Lights::sample_area(const Entry& entry, const AreaLight& area, const Vec3d& point,
                                               const spectral::PathWavelengths& path, double u1, double u2) {
    const spectral::SpectralSample radiance = area.radiance(path);
    if (const auto& ball = entry.ball; ball && is_outside(*ball, point)) {
        const Vec3d way = ball->centre - point;
        const double down = one_minus_cosine(ball->radius_mm, dot(way, way));
        const Vec3d direction = Basis(normalized(way)).to_world(in_cone(1.0 - down, u1, u2));
        // The near side: before the ray's closest approach to the centre.
        const double along = dot(way, direction);
        const Vec3d off_axis = way - along * direction;
        const double depth = std::sqrt(std::max(0.0, ball->radius_mm * ball->radius_mm - dot(off_axis, off_axis)));
        // Less what keeps the ball's own surface, and rounding, from standing in the way.
        const double clear = 0x1p-46 * (largest_coordinate(point) + length(way) + ball->radius_mm);
        const double density = 1.0 / (2.0 * kPi * down);
        return LightSample{.direction = direction,
                           .end = point + (along - depth - clear) * direction,
                           .value = scaled(radiance, 1.0 / density),
                           .density = density,
                           .leaving_per_sample = leaving_surface(area, 1.0 / entry.surface->area_mm2()) / density};
    }
    const SurfaceSample on_light = entry.surface->sample(u1, u2);
    const Vec3d way = on_light.point - point;
    const double distance2 = dot(way, way);
    const Vec3d direction = normalized(way);
    const double cosine = -dot(on_light.geometric_normal, direction);
    if (!(distance2 > 0.0) || cosine == 0.0 || (cosine < 0.0 && !area.is_two_sided)) {
        return {};
    }
    const double density = on_light.density_per_mm2 * distance2 / std::abs(cosine);
    return LightSample{
        .direction = direction,
        .end = ray_origin(on_light.point, on_light.geometric_normal, on_light.error_mm, -1.0 * direction),
        .value = scaled(radiance, 1.0 / density),
        .density = density,
        .leaving_per_sample = leaving_surface(area, on_light.density_per_mm2) / density};
}

double Lights::area_density(const Entry& entry, const Vec3d& at, double per_mm2, const Vec3d& from, double cosine) {
    if (const auto& ball = entry.ball; ball && is_outside(*ball, from)) {
        const Vec3d way = ball->centre - from;
        return 1.0 / (2.0 * kPi * one_minus_cosine(ball->radius_mm, dot(way, way)));
    }
    const Vec3d way = at - from;
    return per_mm2 * dot(way, way) / std::abs(cosine);
}

/// By a millionth of the radius squared: nearer points see nearly half of the ball, and sample its area.
bool Lights::is_outside(const Ball& ball, const Vec3d& point) {
    const Vec3d way = ball.centre - point;
    return dot(way, way) > ball.radius_mm * ball.radius_mm * (1.0 + 1e-6);
}

std::optional<LightSample> Lights::sample(const Vec3d& point, const spectral::PathWavelengths& path, double u_light,
                                          double u1, double u2) const {
    if (is_empty()) {
        return {};
    }
    const Entry& entry = *choose(u_light).entry;
    const auto towards_infinity = [&](const Vec3d& direction, const spectral::SpectralSample& radiance,
                                      double density) {
        return LightSample{.direction = direction,
                           .end = point + beyond_mm(point) * direction,
                           .value = scaled(radiance, 1.0 / density),
                           .density = density,
                           .leaving_per_sample = crossing_density_};
    };
    std::optional<LightSample> found = std::visit(
        Overloaded{[&](const AreaLight& area) { return sample_area(entry, area, point, path, u1, u2); },
                   [&](const PointLight& light) {
                       return from_point(light.position, light.intensity(path), point, cone(-1.0));
                   },
                   [&](const SpotLight& spot) -> std::optional<LightSample> {
                       auto lit = from_point(spot.position, spot.intensity(path), point, cone(spot.cos_outer));
                       const double share = lit ? spot_falloff(spot, -dot(lit->direction, spot.axis)) : 0.0;
                       if (share == 0.0) {
                           return {};
                       }
                       lit->value *= static_cast<float>(share);
                       return lit;
                   },
                   [&](const SunLight& sun) -> std::optional<LightSample> {
                       const Vec3d direction = Basis(sun.towards).to_world(in_cone(sun.cos_radius, u1, u2));
                       return towards_infinity(direction, sun.radiance(path), 1.0 / cone(sun.cos_radius));
                   },
                   [&](const ConstantLight& sky) -> std::optional<LightSample> {
                       return towards_infinity(in_cone(-1.0, u1, u2), sky.radiance(path), 1.0 / (4.0 * kPi));
                   },
                   [&](const EnvironmentLight& sky) -> std::optional<LightSample> {
                       const Environment::Draw drawn = sky.map->draw(u1, u2);
                       if (!(drawn.density > 0.0)) {
                           return {};
                       }
                       return towards_infinity(drawn.direction, sky.map->radiance(drawn.direction, path),
                                               drawn.density);
                   }},
        entry.light);
    if (found) {
        found->value = scaled(found->value, 1.0 / entry.probability);
        found->density *= entry.probability;
    }
    return found;
}

Lights::Emission Lights::emitted(const SurfaceHit& hit, const Vec3d& from, const Vec3d& direction,
                                 const spectral::PathWavelengths& path) const {
    const std::int32_t index = of_object_[hit.object];
    if (index < 0) {
        return {};
    }
    const Entry& entry = lights_[static_cast<std::size_t>(index)];
    const auto& area = std::get<AreaLight>(entry.light);
    const double cosine = -dot(hit.geometric_normal, direction);
    if (cosine == 0.0 || (cosine < 0.0 && !area.is_two_sided)) {
        return {};
    }
    const double per_mm2 = entry.surface->density_per_mm2(hit);
    return {.radiance = area.radiance(path),
            .density = entry.probability * area_density(entry, hit.point, per_mm2, from, cosine),
            .start_density = entry.probability * per_mm2 / (area.is_two_sided ? 2.0 : 1.0),
            .leaving_density = entry.probability * leaving_surface(area, per_mm2)};
}

Lights::Emission Lights::at_infinity(const Entry& entry, const Vec3d& direction,
                                     const spectral::PathWavelengths& path) const {
    const auto emission = [&](const spectral::SpectralSample& radiance, double density) {
        const double chosen = entry.probability * density;
        return Emission{.radiance = radiance,
                        .density = chosen,
                        .start_density = chosen,
                        .leaving_density = chosen * crossing_density_};
    };
    if (const auto* sky = std::get_if<ConstantLight>(&entry.light)) {
        return emission(sky->radiance(path), 1.0 / (4.0 * kPi));
    }
    if (const auto* picture = std::get_if<EnvironmentLight>(&entry.light)) {
        return emission(picture->map->radiance(direction, path), picture->map->density(direction));
    }
    const auto& sun = std::get<SunLight>(entry.light);
    // 1 − cos of the angle between unit vectors, from their difference: a narrow disc's edge does not cancel.
    const Vec3d apart = direction - sun.towards;
    if (0.5 * dot(apart, apart) > 1.0 - sun.cos_radius) {
        return {};
    }
    return emission(sun.radiance(path), 1.0 / cone(sun.cos_radius));
}

LightStart Lights::start(const spectral::PathWavelengths& path, double u_light, double u1, double u2) const {
    const auto [chosen, rest] = choose(u_light);
    LightStart start;
    start.light = static_cast<std::uint32_t>(chosen - lights_.data());
    const auto from_infinity = [&](const Vec3d& towards, const spectral::SpectralSample& radiance, double density) {
        start.is_at_infinity = true;
        start.direction = -1.0 * towards;
        start.value = scaled(radiance, density > 0.0 ? 1.0 / density : 0.0);
        start.density = density;
    };
    std::visit(Overloaded{[&, &entry = *chosen, &of_side = rest](const AreaLight& area) {
                              const SurfaceSample drawn = entry.surface->sample(u1, u2);
                              const bool is_back = area.is_two_sided && of_side >= 0.5;
                              start.point = drawn.point;
                              start.normal = is_back ? -1.0 * drawn.geometric_normal : drawn.geometric_normal;
                              start.error_mm = drawn.error_mm;
                              const double sides = area.is_two_sided ? 2.0 : 1.0;
                              start.value =
                                  scaled(area.radiance(path), sides * kSquareMetresPerSquareMm / drawn.density_per_mm2);
                              start.density = drawn.density_per_mm2 / sides;
                          },
                          [&](const PointLight& point) {
                              start.point = point.position;
                              start.value = point.intensity(path);
                          },
                          [&](const SpotLight& spot) {
                              start.point = spot.position;
                              start.value = spot.intensity(path);
                          },
                          [&](const SunLight& sun) {
                              from_infinity(Basis(sun.towards).to_world(in_cone(sun.cos_radius, u1, u2)),
                                            sun.radiance(path), 1.0 / cone(sun.cos_radius));
                          },
                          [&](const ConstantLight& sky) {
                              from_infinity(in_cone(-1.0, u1, u2), sky.radiance(path), 1.0 / (4.0 * kPi));
                          },
                          [&](const EnvironmentLight& sky) {
                              const Environment::Draw drawn = sky.map->draw(u1, u2);
                              from_infinity(drawn.direction, sky.map->radiance(drawn.direction, path), drawn.density);
                          }},
               chosen->light);
    start.value = scaled(start.value, 1.0 / chosen->probability);
    start.density *= chosen->probability;
    return start;
}

LightWay Lights::way(const LightStart& start, const Vec3d& to) const {
    const Entry& entry = lights_[start.light];
    if (start.is_at_infinity) {
        return {.hit_per_leaving = 1.0 / (start.density * crossing_density_),
                .sample_per_leaving = 1.0 / crossing_density_};
    }
    const Vec3d way = to - start.point;
    if (const auto* area = std::get_if<AreaLight>(&entry.light)) {
        const double leaving = start.density / kPi;
        const double per_mm2 = start.density * (area->is_two_sided ? 2.0 : 1.0);
        const double cosine = dot(start.normal, normalized(way));
        const double sampled = entry.ball && is_outside(*entry.ball, to)
                                   ? entry.probability * area_density(entry, start.point, 0.0, to, cosine)
                                   : area_density(entry, start.point, per_mm2, to, cosine);
        return {.hit_per_leaving = 1.0 / leaving, .sample_per_leaving = sampled / leaving};
    }
    const auto* spot = std::get_if<SpotLight>(&entry.light);
    return {.sample_per_leaving = cone(spot != nullptr ? spot->cos_outer : -1.0) * dot(way, way)};
}

spectral::SpectralSample Lights::intensity(const LightStart& start, const Vec3d& direction) const {
    const LightSource& light = lights_[start.light].light;
    if (const auto* spot = std::get_if<SpotLight>(&light)) {
        return scaled(start.value, spot_falloff(*spot, dot(direction, spot->axis)));
    }
    return std::holds_alternative<AreaLight>(light) ? scaled(start.value, std::max(0.0, dot(direction, start.normal)))
                                                    : start.value;
}

EmittedRay Lights::leave(const LightStart& start, double u1, double u2) const {
    if (start.is_at_infinity) {
        // It crosses a disc in front of the scene, at right angles to its way.
        const Vec2d at = in_disc(u1, u2);
        const Vec3d origin = centre_ + radius_mm_ * Basis(-1.0 * start.direction).to_world({at.x, at.y, 1.0});
        const double area = kPi * radius_mm_ * radius_mm_ * kSquareMetresPerSquareMm;
        return {{origin, start.direction}, scaled(start.value, area)};
    }
    const LightSource& light = lights_[start.light].light;
    if (std::holds_alternative<AreaLight>(light)) {
        // With the density cos / π.
        const Vec3d direction = Basis(start.normal).to_world(cosine_direction(u1, u2));
        return {{ray_origin(start.point, start.normal, start.error_mm, direction), direction},
                scaled(start.value, kPi)};
    }
    const auto* spot = std::get_if<SpotLight>(&light);
    const double cos_half_angle = spot != nullptr ? spot->cos_outer : -1.0;
    const Vec3d in_frame = in_cone(cos_half_angle, u1, u2);
    const Vec3d direction = spot != nullptr ? Basis(spot->axis).to_world(in_frame) : in_frame;
    return {{start.point, direction}, scaled(intensity(start, direction), cone(cos_half_angle))};
}

}  // namespace lensproof::scene
