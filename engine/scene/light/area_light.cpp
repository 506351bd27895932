#include "engine/scene/light/area_light.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "engine/base/basis.h"

namespace lensproof::scene {

namespace {

/// The cone under which a point outside sees a ball: 1 − the cosine of its half-angle, without cancelling.
double one_minus_cosine(double radius_mm, double distance2) {
    const double sine2 = radius_mm * radius_mm / distance2;
    return sine2 / (1.0 + std::sqrt(1.0 - sine2));
}

}  // namespace

ShiningSurface::ShiningSurface(const SceneGeometry& scene, const AreaLight& light)
    : sampler_(scene, light.object), ball_(ball_of(scene, light)) {}

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
                                                  const spectral::PathWavelengths& path, double u1, double u2) const {
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
    const SurfaceSample on_light = sampler_.sample(u1, u2);
    const Vec3d to_light = on_light.point - point;
    const double distance2 = dot(to_light, to_light);
    const Vec3d direction = normalized(to_light);
    const double cosine = -dot(on_light.geometric_normal, direction);
    if (!(distance2 > 0.0) || cosine == 0.0 || (cosine < 0.0 && !light.is_two_sided)) {
        return {};
    }
    const double pdf = on_light.pdf_per_mm2 * distance2 / std::abs(cosine);
    return LightSample{
        .direction = direction,
        .end = ray_origin(on_light.point, on_light.geometric_normal, on_light.error_mm, -1.0 * direction),
        .value = scaled(light.radiance_at(on_light.uv, path), 1.0 / pdf),
        .pdf = pdf,
        .leaving_per_sample = light.leaving_pdf(on_light.pdf_per_mm2) / pdf};
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
