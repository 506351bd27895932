#include "engine/scene/light/light.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "engine/base/angle.h"
#include "engine/base/basis.h"
#include "engine/base/overloaded.h"
#include "engine/scene/bsdf/directions.h"

namespace lensproof::scene {

namespace {

/// A point of the disc of radius 1, evenly.
Vec2d in_disc(double u1, double u2) {
    const double radius = std::sqrt(u1);
    return {radius * std::cos(2.0 * kPi * u2), radius * std::sin(2.0 * kPi * u2)};
}

std::optional<LightSample> sample_point(const LightAtPoint auto& light, const Vec3d& seen_from,
                                        const spectral::PathWavelengths& path) {
    const Vec3d to_light = light.position - seen_from;
    const double distance2 = dot(to_light, to_light);
    if (!(distance2 > 0.0)) {
        return {};
    }
    const Vec3d direction = normalized(to_light);
    const double falloff = light.falloff(-1.0 * direction);
    if (falloff == 0.0) {
        return {};
    }
    return LightSample{
        .direction = direction,
        .end = light.position,
        .value = scaled(scaled(light.intensity(path), 1.0 / (distance2 * kSquareMetresPerSquareMm)), falloff),
        .leaving_per_sample = 1.0 / (light.cone_sr() * distance2)};
}

}  // namespace

Lights::Lights(const SceneGeometry& scene, std::vector<LightSource> lights) : of_object_(scene.object_count(), -1) {
    const Box& box = scene.bounds();
    centre_ = 0.5 * (box.low + box.high);
    radius_mm_ = 0.5 * length(box.high - box.low);
    const double cross_section = kPi * radius_mm_ * radius_mm_ * kSquareMetresPerSquareMm;
    crossing_pdf_ = radius_mm_ > 0.0 ? 1.0 / (kPi * radius_mm_ * radius_mm_) : 0.0;
    std::vector<double> powers;
    for (LightSource& light : lights) {
        std::optional<ShiningSurface> surface;
        const auto index = static_cast<std::uint32_t>(lights_.size());
        powers.push_back(std::visit(Overloaded{[&](const AreaLight& area) {
                                                   surface.emplace(scene, area);
                                                   of_object_[area.object] = static_cast<std::int32_t>(index);
                                                   return surface->power(area);
                                               },
                                               [](const LightAtPoint auto& point) { return point.power(); },
                                               [&](const LightAtInfinity auto& sky) {
                                                   at_infinity_.push_back(index);
                                                   return sky.irradiance() * cross_section;
                                               }},
                                    light));
        if (const auto* sky = std::get_if<EnvironmentLight>(&light); sky != nullptr && map_ == nullptr) {
            map_ = sky->map.get();
        }
        lights_.push_back({.light = std::move(light), .surface = std::move(surface)});
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

std::optional<LightSample> Lights::sample(const Vec3d& point, const spectral::PathWavelengths& path, double u_light,
                                          double u1, double u2) const {
    if (is_empty()) {
        return {};
    }
    const Entry& entry = *choose(u_light).entry;
    std::optional<LightSample> found =
        std::visit(Overloaded{[&](const AreaLight& area) { return entry.surface->sample(area, point, path, u1, u2); },
                              [&](const LightAtPoint auto& light) { return sample_point(light, point, path); },
                              [&](const LightAtInfinity auto& sky) -> std::optional<LightSample> {
                                  const SkySample drawn = sky.draw(path, u1, u2);
                                  if (!(drawn.pdf > 0.0)) {
                                      return {};
                                  }
                                  return LightSample{.direction = drawn.direction,
                                                     .end = point + beyond_mm(point) * drawn.direction,
                                                     .value = scaled(drawn.radiance, 1.0 / drawn.pdf),
                                                     .place = drawn.place,
                                                     .pdf = drawn.pdf,
                                                     .leaving_per_sample = crossing_pdf_};
                              }},
                   entry.light);
    if (found) {
        found->value = scaled(found->value, 1.0 / entry.probability);
        found->pdf *= entry.probability;
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
    const double per_mm2 = entry.surface->sampler().pdf_per_mm2(hit);
    return {.radiance = area.radiance_at(hit.uv, path),
            .pdf = entry.probability * entry.surface->pdf(hit.point, per_mm2, from, cosine),
            .start_pdf = entry.probability * per_mm2 / area.sides(),
            .leaving_pdf = entry.probability * area.leaving_pdf(per_mm2)};
}

void Lights::expect_sample(double u_light, double u1, double u2) const {
    if (map_ != nullptr) {
        if (const auto* sky = std::get_if<EnvironmentLight>(&choose(u_light).entry->light)) {
            sky->map->expect_draw(u1, u2);
        }
    }
}

Lights::Emission Lights::at_infinity(const Entry& entry, const Vec3d& direction, const MapPlace& ahead,
                                     const spectral::PathWavelengths& path) const {
    const SkySample seen =
        std::visit(Overloaded{[&](const EnvironmentLight& sky) { return sky.seen(direction, path, ahead); },
                              [&](const LightAtInfinity auto& sky) { return sky.seen(direction, path); },
                              [](const auto& /*nearer*/) { return SkySample(); }},
                   entry.light);
    const double pdf = entry.probability * seen.pdf;
    return {.radiance = seen.radiance, .pdf = pdf, .start_pdf = pdf, .leaving_pdf = pdf * crossing_pdf_};
}

LightStart Lights::start(const spectral::PathWavelengths& path, double u_light, double u1, double u2) const {
    const auto [chosen, rest] = choose(u_light);
    LightStart start;
    start.light = static_cast<std::uint32_t>(chosen - lights_.data());
    std::visit(Overloaded{[&, &surface = chosen->surface, &of_side = rest](const AreaLight& area) {
                              const SurfaceSample drawn = surface->sampler().sample(u1, u2);
                              const bool is_back = area.is_two_sided && of_side >= 0.5;
                              start.point = drawn.point;
                              start.normal = is_back ? -1.0 * drawn.geometric_normal : drawn.geometric_normal;
                              start.error_mm = drawn.error_mm;
                              start.value = scaled(area.radiance_at(drawn.uv, path),
                                                   area.sides() * kSquareMetresPerSquareMm / drawn.pdf_per_mm2);
                              start.pdf = drawn.pdf_per_mm2 / area.sides();
                          },
                          [&](const LightAtPoint auto& light) {
                              start.point = light.position;
                              start.value = light.intensity(path);
                          },
                          [&](const LightAtInfinity auto& sky) {
                              const SkySample drawn = sky.draw(path, u1, u2);
                              start.is_at_infinity = true;
                              start.direction = -1.0 * drawn.direction;
                              start.value = scaled(light_of(drawn.radiance, drawn.place, path),
                                                   drawn.pdf > 0.0 ? 1.0 / drawn.pdf : 0.0);
                              start.pdf = drawn.pdf;
                          }},
               chosen->light);
    start.value = scaled(start.value, 1.0 / chosen->probability);
    start.pdf *= chosen->probability;
    return start;
}

FirstSegment Lights::first_segment(const LightStart& start, const Vec3d& to) const {
    const Entry& entry = lights_[start.light];
    const Vec3d along = to - start.point;
    return std::visit(Overloaded{[&](const AreaLight& area) -> FirstSegment {
                                     const double leaving = start.pdf / kPi;
                                     const double per_mm2 = start.pdf * area.sides();
                                     const double cosine = dot(start.normal, normalized(along));
                                     const double pdf = entry.surface->pdf(start.point, per_mm2, to, cosine);
                                     // The start's own holds the choice of the light, a cone's does not.
                                     const double sampled =
                                         entry.surface->is_seen_as_cone(to) ? entry.probability * pdf : pdf;
                                     return {.hit_per_leaving = 1.0 / leaving, .sample_per_leaving = sampled / leaving};
                                 },
                                 [&](const LightAtPoint auto& light) -> FirstSegment {
                                     return {.sample_per_leaving = light.cone_sr() * dot(along, along)};
                                 },
                                 [&](const LightAtInfinity auto& /*sky*/) -> FirstSegment {
                                     return {.hit_per_leaving = 1.0 / (start.pdf * crossing_pdf_),
                                             .sample_per_leaving = 1.0 / crossing_pdf_};
                                 }},
                      entry.light);
}

spectral::SpectralSample Lights::intensity(const LightStart& start, const Vec3d& direction) const {
    return std::visit(
        Overloaded{[&](const AreaLight&) { return scaled(start.value, std::max(0.0, dot(direction, start.normal))); },
                   [&](const LightAtPoint auto& light) { return scaled(start.value, light.falloff(direction)); },
                   [&](const LightAtInfinity auto& /*sky*/) { return start.value; }},
        lights_[start.light].light);
}

EmittedRay Lights::leave(const LightStart& start, double u1, double u2) const {
    return std::visit(
        Overloaded{
            [&](const AreaLight&) -> EmittedRay {
                // With the pdf cos / π.
                const Vec3d direction = Basis(start.normal).to_world(cosine_direction(u1, u2));
                return {{ray_origin(start.point, start.normal, start.error_mm, direction), direction},
                        scaled(start.value, kPi)};
            },
            [&](const LightAtPoint auto& light) -> EmittedRay {
                const Vec3d direction = light.draw(u1, u2);
                return {{start.point, direction},
                        scaled(scaled(start.value, light.falloff(direction)), light.cone_sr())};
            },
            [&](const LightAtInfinity auto& /*sky*/) -> EmittedRay {
                // It crosses a disc in front of the scene, at right angles to its direction.
                const Vec2d at = in_disc(u1, u2);
                const Vec3d origin = centre_ + radius_mm_ * Basis(-1.0 * start.direction).to_world({at.x, at.y, 1.0});
                const double area = kPi * radius_mm_ * radius_mm_ * kSquareMetresPerSquareMm;
                return {{origin, start.direction}, scaled(start.value, area)};
            }},
        lights_[start.light].light);
}

}  // namespace lensproof::scene
