#include "engine/scene/light/area_light.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "engine/base/basis.h"
#include "engine/scene/geometry/facet.h"
#include "engine/scene/light/packet/facet_kernels.h"

namespace lensproof::scene {

namespace {

/// The cone under which a point outside sees a ball: 1 − the cosine of its half-angle, without cancelling.
double one_minus_cosine(double radius_mm, double distance2) {
    const double sine2 = radius_mm * radius_mm / distance2;
    return sine2 / (1.0 + std::sqrt(1.0 - sine2));
}

}  // namespace

ShiningSurface::ShiningSurface(const SceneGeometry& scene, const AreaLight& light)
    : sampler_(scene, light.object),
      facets_(light.picture == nullptr ? facets_of(sampler_) : ShiningFacets()),
      ball_(ball_of(scene, light)) {}

ShiningFacets ShiningSurface::facets_of(const SurfaceSampler& sampler) {
    const std::span<const Facet> facets = sampler.facets();
    if (facets.empty() || facets.size() > kFewTriangles) {
        return {};
    }
    ShiningFacets shining{.is_quad = sampler.areas_to_mm2().empty(),
                          .areas_to_mm2 = {sampler.areas_to_mm2().begin(), sampler.areas_to_mm2().end()},
                          .pdf_per_mm2 = 1.0 / sampler.area_mm2()};
    for (const Facet& facet : facets) {
        shining.first.push_back(facet.sides.first);
        shining.to_second.push_back(facet.sides.to_second);
        shining.to_third.push_back(facet.sides.to_third);
        shining.normal.push_back(facet.normal);
        shining.error_mm.push_back(facet.error_mm);
    }
    return shining;
}

std::optional<ShiningSurface::Ball> ShiningSurface::ball_of(const SceneGeometry& scene, const AreaLight& light) {
    const auto* sphere = std::get_if<Sphere>(&scene.shape(light.object));
    const AffineMap& map = scene.object(light.object).to_world;
    const Vec3d stretches = principal_stretches(map.linear);
    if (light.is_two_sided || light.picture != nullptr || sphere == nullptr ||
        stretches.x - stretches.z > 1e-12 * stretches.x) {
        return {};
    }
    return Ball{map.translation, stretches.x * sphere->radius_mm};
}

double ShiningSurface::mean_radiance(const AreaLight& light) const {
    if (light.picture == nullptr) {
        return mean_of(light.radiance);
    }
    // The pixels next to evenly spread points, as a generalised golden ratio spreads them; half of it the whole
    // picture's, so that no lit spot which they miss is left without.
    const std::vector<float> means = mean_over_grid(*light.picture);
    const ImageTexture& picture = *light.picture;
    constexpr int kPoints = 4096;
    double sum = 0.0;
    for (int i = 0; i < kPoints; ++i) {
        const double u1 = std::fmod(0.5 + i * 0.7548776662466927, 1.0);
        const double u2 = std::fmod(0.5 + i * 0.5698402909980532, 1.0);
        sum += means[nearest_texel(picture, sampler_.sample(u1, u2).uv)];
    }
    return 0.5 * sum / kPoints +
           0.5 * std::accumulate(means.begin(), means.end(), 0.0) / static_cast<double>(means.size());
}

double ShiningSurface::power(const AreaLight& light) const {
    return light.sides() * std::numbers::pi * mean_radiance(light) * sampler_.area_mm2() * kSquareMetresPerSquareMm;
}

std::optional<LightSample> ShiningSurface::sample(const AreaLight& light, const Vec3d& point,
                                                  const spectral::PathWavelengths& path,
                                                  const LightNumbers& numbers) const {
    const auto& [u1, u2] = numbers.of_point;
    if (is_seen_as_cone(point)) {
        const Vec3d to_centre = ball_->centre - point;
        const double down = one_minus_cosine(ball_->radius_mm, dot(to_centre, to_centre));
        const Vec3d direction = Basis(normalized(to_centre)).to_world(in_cone(1.0 - down, u1, u2));
        // The near side: before the ray's closest approach to the centre.
        const double along = dot(to_centre, direction);
        const Vec3d off_axis = to_centre - along * direction;
        const double depth = std::sqrt(std::max(0.0, ball_->radius_mm * ball_->radius_mm - dot(off_axis, off_axis)));
        // Less what keeps the ball's own surface, and rounding, from standing in the way.
        const double clear = 0x1p-46 * (largest_coordinate(point) + length(to_centre) + ball_->radius_mm);
        const double pdf = 1.0 / (2.0 * std::numbers::pi * down);
        return LightSample{.direction = direction,
                           .end = point + (along - depth - clear) * direction,
                           .value = scaled(light.radiance(path), 1.0 / pdf),
                           .pdf = pdf,
                           .leaving_per_sample = light.leaving_pdf(1.0 / sampler_.area_mm2()) / pdf};
    }
    const auto seen = [&](const ShiningView<double>& view, double pdf_per_mm2, const Vec2d& uv) {
        const bool is_lit = view.cosine > 0.0 || (view.cosine < 0.0 && light.is_two_sided);
        return is_lit ? std::optional(LightSample{.direction = view.direction,
                                                  .end = view.end,
                                                  .value = scaled(light.radiance_at(uv, path), view.per_pdf),
                                                  .pdf = view.pdf,
                                                  .leaving_per_sample = light.leaving_pdf(pdf_per_mm2) * view.per_pdf})
                      : std::nullopt;
    };
    const auto* ahead = std::get_if<SurfaceDraw>(&numbers.ahead);
    if (ahead != nullptr && ahead->surface == this) {
        return seen(ahead->view, facets_.pdf_per_mm2, {});
    }
    const SurfaceSample drawn = sampler_.sample(u1, u2);
    return seen(seen_from<double>(point, {drawn.point, drawn.geometric_normal, drawn.error_mm, drawn.pdf_per_mm2}),
                drawn.pdf_per_mm2, drawn.uv);
}

void ShiningSurface::draw_ahead(std::span<const Vec3d> points, std::span<LightNumbers> numbers) const {
    for (std::size_t first = 0; !facets_.is_empty() && first < points.size(); first += ViewColumns::kMost) {
        const std::size_t count = std::min(points.size() - first, ViewColumns::kMost);
        ViewColumns columns;
        for (std::size_t i = 0; i < count; ++i) {
            columns.add(points[first + i], numbers[first + i].of_point);
        }
        facet_kernels().see(facets_, columns);
        for (std::size_t i = 0; i < count; ++i) {
            numbers[first + i].ahead = SurfaceDraw{this, columns.view(i)};
        }
    }
}

double ShiningSurface::pdf(const Vec3d& at, double per_mm2, const Vec3d& from, double cosine) const {
    if (is_seen_as_cone(from)) {
        const Vec3d to_centre = ball_->centre - from;
        return 1.0 / (2.0 * std::numbers::pi * one_minus_cosine(ball_->radius_mm, dot(to_centre, to_centre)));
    }
    const Vec3d to_light = at - from;
    return per_mm2 * dot(to_light, to_light) / std::abs(cosine);
}

bool ShiningSurface::is_seen_as_cone(const Vec3d& from) const {
    if (!ball_) {
        return false;
    }
    const Vec3d to_centre = ball_->centre - from;
    return dot(to_centre, to_centre) > ball_->radius_mm * ball_->radius_mm * (1.0 + 1e-6);
}

}  // namespace lensproof::scene
