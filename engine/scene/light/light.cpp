#include "engine/scene/light/light.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>
#include <utility>

#include "engine/base/angle.h"
#include "engine/base/basis.h"
#include "engine/base/disc.h"
#include "engine/base/infinity.h"
#include "engine/base/overloaded.h"
#include "engine/scene/bsdf/directions.h"

namespace lensproof::scene {

namespace {

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

std::vector<Vec3d> points_over(const SurfaceSampler& surface) {
    constexpr int kSide = 4;
    std::vector<Vec3d> points;
    points.reserve(std::size_t{kSide} * kSide);
    for (int row = 0; row < kSide; ++row) {
        for (int column = 0; column < kSide; ++column) {
            points.push_back(surface.sample((column + 0.5) / kSide, (row + 0.5) / kSide).point);
        }
    }
    return points;
}

/// The mean of a few points of a surface, and the squared distance of the farthest from it.
std::pair<Vec3d, double> middle_of(const SurfaceSampler& surface) {
    const std::vector<Vec3d> points = points_over(surface);
    Vec3d middle;
    for (const Vec3d& point : points) {
        middle = middle + (1.0 / static_cast<double>(points.size())) * point;
    }
    double farthest2 = 0.0;
    for (const Vec3d& point : points) {
        farthest2 = std::max(farthest2, dot(point - middle, point - middle));
    }
    return {middle, farthest2};
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
        Entry entry{.light = std::move(light), .surface = std::move(surface)};
        std::visit(Overloaded{[&](const AreaLight&) {
                                  std::tie(entry.middle, entry.extent2_mm2) = middle_of(entry.surface->sampler());
                              },
                              [&](const LightAtPoint auto& point) { entry.middle = point.position; },
                              [&](const SunLight& sun) {
                                  suns_.push_back(index);
                                  entry.direction = sun.towards;
                              },
                              [](const LightAtInfinity auto& /*all about*/) {}},
                   entry.light);
        const double per = entry.middle ? 4.0 * kPi * kSquareMetresPerSquareMm : cross_section;
        entry.irradiance = entry.is_directed() && per > 0.0 ? powers.back() / per : 0.0;
        lights_.push_back(std::move(entry));
    }
    power_ = std::accumulate(powers.begin(), powers.end(), 0.0);
    double sum = 0.0;
    for (std::size_t i = 0; i < lights_.size(); ++i) {
        // Lights without power in the grid's band are never drawn, unless there are no others.
        lights_[i].probability = power_ > 0.0 ? powers[i] / power_ : 1.0 / static_cast<double>(lights_.size());
        cumulative_.push_back(sum += lights_[i].probability);
        directed_ += lights_[i].is_directed() ? lights_[i].probability : 0.0;
    }
}

Lights::Chosen Lights::choose(double u) const {
    const double target = u * cumulative_.back();
    const auto after = std::ranges::upper_bound(cumulative_, target);
    const std::size_t at = std::min(static_cast<std::size_t>(after - cumulative_.begin()), lights_.size() - 1);
    const double before = at > 0 ? cumulative_[at - 1] : 0.0;
    const double rest = (target - before) / (cumulative_[at] - before);
    return {&lights_[at], lights_[at].probability, std::clamp(rest, 0.0, 1.0 - 0x1p-53)};
}

Lights::Entry::Seen Lights::Entry::seen_from(const Vec3d& point) const {
    if (!middle) {
        return {direction.value_or(Vec3d{}), irradiance};
    }
    const Vec3d to = *middle - point;
    const double distance2 = dot(to, to);
    return distance2 > 0.0 ? Seen{normalized(to), irradiance / std::max(distance2, extent2_mm2)} : Seen{};
}

Lights::Chosen Lights::choose(double u, std::span<const double> weights) const {
    constexpr double kByPower = 0.1;
    Chosen chosen = choose(u);
    const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
    if (!(sum > 0.0 && sum < kInfinity) || !chosen.entry->is_directed()) {
        return chosen;
    }
    auto at = static_cast<std::size_t>(chosen.entry - lights_.data());
    if (chosen.rest >= kByPower) {
        double rest = (chosen.rest - kByPower) / (1.0 - kByPower) * sum;
        for (std::size_t i = 0; i < weights.size(); ++i) {
            if (weights[i] > 0.0) {
                at = i;  // the last of them where rounding leaves a rest
                if (rest < weights[i]) {
                    break;
                }
            }
            rest -= weights[i];
        }
    }
    const Entry& entry = lights_[at];
    return {.entry = &entry,
            .probability = kByPower * entry.probability + (1.0 - kByPower) * directed_ * weights[at] / sum};
}

std::optional<LightSample> Lights::sample_of(const Chosen& chosen, const Vec3d& point,
                                             const spectral::PathWavelengths& path, const LightNumbers& numbers) const {
    const Entry& entry = *chosen.entry;
    const double u1 = numbers.of_point.x;
    const double u2 = numbers.of_point.y;
    const auto of_sky = [&](const SkySample& drawn) -> std::optional<LightSample> {
        if (!(drawn.pdf > 0.0)) {
            return {};
        }
        return LightSample{.direction = drawn.direction,
                           .end = point + beyond_mm(point) * drawn.direction,
                           .value = scaled(drawn.radiance, 1.0 / drawn.pdf),
                           .place = drawn.place,
                           .pdf = drawn.pdf,
                           .leaving_per_sample = crossing_pdf_};
    };
    std::optional<LightSample> found =
        std::visit(Overloaded{[&](const AreaLight& area) { return entry.surface->sample(area, point, path, numbers); },
                              [&](const LightAtPoint auto& light) { return sample_point(light, point, path); },
                              [&](const EnvironmentLight& sky) {
                                  const auto* ahead = std::get_if<MapDraw>(&numbers.ahead);
                                  return of_sky(sky.draw(path, u1, u2, ahead != nullptr ? *ahead : MapDraw{}));
                              },
                              [&](const LightAtInfinity auto& sky) { return of_sky(sky.draw(path, u1, u2)); }},
                   entry.light);
    if (found) {
        found->value = scaled(found->value, 1.0 / chosen.probability);
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

void Lights::draw_ahead(std::span<const Vec3d> points, std::span<LightNumbers> numbers) const {
    if (lights_.size() == 1 && lights_.front().surface) {
        lights_.front().surface->draw_ahead(points, numbers);
    }
    constexpr std::size_t kMost = 64;
    std::array<Vec2d, kMost> of_points;
    std::array<LightNumbers*, kMost> of_map{};
    std::array<MapDraw, kMost> draws;
    for (std::size_t i = 0; map_ != nullptr && i < numbers.size();) {
        std::size_t count = 0;
        for (; i < numbers.size() && count < kMost; ++i) {
            const auto* sky = std::get_if<EnvironmentLight>(&choose(numbers[i].of_light).entry->light);
            if (sky != nullptr && sky->map.get() == map_) {
                of_points[count] = numbers[i].of_point;
                of_map[count++] = &numbers[i];
            }
        }
        map_->draw(std::span(of_points).first(count), draws);
        for (std::size_t k = 0; k < count; ++k) {
            of_map[k]->ahead = draws[k];
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
    return {.radiance = seen.radiance,
            .pdf = pdf,
            .start_pdf = pdf,
            .leaving_pdf = pdf * crossing_pdf_,
            .is_sun = std::holds_alternative<SunLight>(entry.light)};
}

LightStart Lights::start(const spectral::PathWavelengths& path, double u_light, double u1, double u2) const {
    return start_at(choose(u_light), path, u1, u2);
}

LightStart Lights::start_at_sun(const spectral::PathWavelengths& path, double u_light, double u1, double u2) const {
    double all = 0.0;
    for (const std::uint32_t sun : suns_) {
        all += lights_[sun].probability;
    }
    const Entry* chosen = &lights_[suns_.back()];
    double before = 0.0;
    for (const std::uint32_t sun : suns_) {
        before += lights_[sun].probability;
        if (u_light * all < before) {
            chosen = &lights_[sun];
            break;
        }
    }
    // Suns without power in the grid's band are drawn alike where there are no others.
    const double probability = all > 0.0 ? chosen->probability / all : 1.0;
    return start_at({.entry = chosen, .probability = probability}, path, u1, u2);
}

std::vector<SunLight> Lights::suns() const {
    std::vector<SunLight> suns;
    for (const std::uint32_t sun : suns_) {
        suns.push_back(std::get<SunLight>(lights_[sun].light));
    }
    return suns;
}

std::vector<Vec3d> Lights::points_of(std::size_t i) const {
    const Entry& entry = lights_[i];
    if (entry.surface) {
        return points_over(entry.surface->sampler());
    }
    return entry.middle ? std::vector{*entry.middle} : std::vector<Vec3d>{};
}

LightStart Lights::start_at(const Chosen& chosen, const spectral::PathWavelengths& path, double u1, double u2) const {
    const auto& [entry, probability, rest] = chosen;
    LightStart start;
    start.light = static_cast<std::uint32_t>(entry - lights_.data());
    std::visit(Overloaded{[&, &surface = entry->surface, &of_side = rest](const AreaLight& area) {
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
                              start.is_sun = std::is_same_v<std::decay_t<decltype(sky)>, SunLight>;
                              start.direction = -1.0 * drawn.direction;
                              start.value = scaled(light_of(drawn.radiance, drawn.place, path),
                                                   drawn.pdf > 0.0 ? 1.0 / drawn.pdf : 0.0);
                              start.pdf = drawn.pdf;
                          }},
               entry->light);
    start.value = scaled(start.value, 1.0 / probability);
    start.pdf *= probability;
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
        Overloaded{[&](const AreaLight&) -> EmittedRay {
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
                       const Disc disc{radius_mm_};
                       const Vec2d at = disc.warped(u1, u2);
                       const Vec3d origin = centre_ + Basis(-1.0 * start.direction).to_world({at.x, at.y, radius_mm_});
                       return {{origin, start.direction}, scaled(start.value, disc.area() * kSquareMetresPerSquareMm)};
                   }},
        lights_[start.light].light);
}

}  // namespace lensproof::scene
