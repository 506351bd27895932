// The MIS weights of the three techniques that make a path, computed from either end of the same path.
#include "engine/render/integrators/mis_weight.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "engine/base/infinity.h"
#include "tests/validation/studio.h"

namespace lensproof::mis_weight_test {

const spectral::SpectralGrid kGrid = spectral::spectral_grid(420.0, 680.0, 16);
const render::Sensor kSensor{.width = 60, .height = 40, .pixel_pitch_mm = 0.6};

/// Numbers in (0, 1), one after the other.
class Numbers {
  public:
    explicit Numbers(std::uint32_t seed) : sampler_(5, 0, seed) {}
    double next() { return sampler_.next()[0]; }

  private:
    render::PathSampler sampler_;
};

/// A path's points, the first nearest to the camera, as rays from the one before met them, and the ray that joins the
/// first to the camera (lens space, inwards).
struct Path {
    std::vector<scene::SurfaceHit> points;
    render::LensSample in;
};

std::optional<scene::SurfaceHit> hit_along(const scene::Scene& scene, const Vec3d& origin, const Vec3d& direction) {
    return scene::intersect(*scene.geometry, origin, direction, 0.0, kInfinity);
}

/// Of so many points: from the middle of the scene a ray to a first point that is joined to the camera, and on at
/// random; directions that a mirror turns are mirrored, so that deltas are met.
std::optional<Path> random_path(const Studio& studio, const spectral::PathWavelengths& strata, int points,
                                Numbers& numbers) {
    const scene::Scene& scene = studio.scene();
    const auto anywhere = [&] {
        return normalized(Vec3d{numbers.next() - 0.5, numbers.next() - 0.5, numbers.next() - 0.5});
    };
    auto hit = hit_along(scene, {0.0, 0.0, 1400.0}, anywhere());
    if (!hit) {
        return {};
    }
    const auto in = studio.camera().sample({hit->point, false}, strata, numbers.next(), numbers.next());
    if (!in || studio.camera().importance(in->ray, strata).transmittance[0] == 0.0) {
        return {};
    }
    Path path{.points = {*hit}, .in = *in};
    Vec3d backwards = in->direction;
    while (static_cast<int>(path.points.size()) < points) {
        const scene::SurfaceHit& last = path.points.back();
        const render::PathVertex vertex(last, backwards, scene, strata);
        const Vec3d onwards = scene::is_delta(vertex.bsdf)
                                  ? vertex.frame.to_world({-vertex.wo.x, -vertex.wo.y, vertex.wo.z})
                                  : anywhere();
        hit = hit_along(scene, scene::ray_origin(last, onwards), onwards);
        if (!hit) {
            return {};
        }
        path.points.push_back(*hit);
        backwards = -1.0 * onwards;
    }
    return path;
}

Vec3d between(const scene::SurfaceHit& from, const scene::SurfaceHit& to) {
    return normalized(to.point - from.point);
}

struct Weights {
    double hit = 0.0;
    double sample = 0.0;
    double join = 0.0;
};

render::PathTurn turn_at(const render::PathVertex& vertex, const Vec3d& onwards, bool is_camera) {
    if (scene::is_delta(vertex.bsdf)) {
        return {.is_delta = true};
    }
    const Vec3d wi = vertex.frame.to_local(onwards);
    return is_camera ? render::camera_turn(vertex, onwards, wi,
                                           scene::pdf(vertex.bsdf, vertex.wo, wi, scene::Transport::radiance))
                     : render::light_turn(vertex, onwards, wi,
                                          scene::pdf(vertex.bsdf, vertex.wo, wi, scene::Transport::importance));
}

/// Whether light goes along the path.
bool is_lit(const scene::Scene& scene, const Path& path, const Vec3d& to_light,
            const spectral::PathWavelengths& strata) {
    Vec3d backwards = path.in.direction;
    for (std::size_t i = 0; i < path.points.size(); ++i) {
        const render::PathVertex vertex(path.points[i], backwards, scene, strata);
        const Vec3d onwards = i + 1 < path.points.size() ? between(path.points[i], path.points[i + 1]) : to_light;
        const Vec3d wi = vertex.frame.to_local(onwards);
        if (!scene::is_delta(vertex.bsdf) &&
            spectral::is_black(scene::evaluate(vertex.bsdf, vertex.wo, wi, scene::Transport::radiance))) {
            return false;
        }
        backwards = -1.0 * onwards;
    }
    return true;
}

/// What ends a path at its last point: the light's sample, and the same seen as a hit and as a start.
struct End {
    scene::LightSample sample;
    scene::Lights::Emission hit;
    double cosine = 1.0;
    scene::LightStart start;
};

/// Light 0 of the scene, as the last point may sample it.
std::optional<End> end_of(const scene::Scene& scene, const scene::SurfaceHit& last,
                          const spectral::PathWavelengths& strata, Numbers& numbers) {
    const auto sample = scene.lights.sample(last.point, strata, {numbers.next(), {numbers.next(), numbers.next()}});
    if (!sample || scene::is_occluded(*scene.geometry, scene::ray_origin(last, sample->direction), sample->end)) {
        return {};
    }
    End end{.sample = *sample, .hit = {}, .start = scene.lights.start(strata, 0.5, 0.5, 0.5)};
    if (end.start.is_point()) {
        return end;
    }
    if (end.start.is_at_infinity) {
        scene.lights.visit_infinity(sample->direction, strata, [&](const auto& found) { end.hit = found; });
        end.start.direction = -1.0 * sample->direction;
    } else {
        const auto on_light = hit_along(scene, scene::ray_origin(last, sample->direction), sample->direction);
        if (!on_light) {
            return {};
        }
        end.hit = scene.lights.emitted(*on_light, last.point, sample->direction, strata);
        end.cosine = std::abs(dot(on_light->geometric_normal, sample->direction));
        end.start.point = on_light->point;
        end.start.normal = on_light->geometric_normal;
    }
    end.start.pdf = end.hit.start_pdf;
    return end.hit.pdf > 0.0 ? std::optional(end) : std::nullopt;
}

Weights weights_of(const Studio& studio, const Path& path, const End& end, const spectral::PathWavelengths& strata,
                   bool is_hero_alone) {
    const scene::Scene& scene = studio.scene();
    const std::size_t n = path.points.size();
    const render::FilmImportance film = studio.camera().importance(path.in.ray, strata);
    const render::LightOrigin first{path.points.front().point, false};
    Weights weights;

    // From the camera. Its ray begins elsewhere on the line.
    const Ray<double> outwards{path.in.ray.origin - 3.0 * path.in.ray.direction, -1.0 * path.in.ray.direction};
    render::CameraMisWeight camera;
    camera.enter(studio.camera().entrance_ratio(studio.camera().pdf(first, outwards, strata),
                                                {.shared = film.shared_pdf(0), .hero = film.pdf[0]}));
    if (is_hero_alone) {
        camera.hero_goes_alone();
    }
    Vec3d backwards = path.in.direction;
    for (std::size_t i = 0; i < n; ++i) {
        const render::PathVertex vertex(path.points[i], backwards, scene, strata);
        const Vec3d onwards = i + 1 < n ? between(path.points[i], path.points[i + 1]) : end.sample.direction;
        const render::PathTurn turn = turn_at(vertex, onwards, true);
        if (i + 1 == n && !turn.is_delta) {
            weights.sample = camera.of_sample(end.sample, turn);
        }
        camera.turn(turn);
        backwards = -1.0 * onwards;
    }
    weights.hit = end.hit.pdf > 0.0 ? camera.of_hit(end.hit, end.cosine) : 0.0;

    // From the light.
    render::LightMisWeight light;
    light.leave(scene.lights.first_segment(end.start, path.points.back().point));
    backwards = end.sample.direction;
    for (std::size_t i = n; i-- > 0;) {
        const render::PathVertex vertex(path.points[i], backwards, scene, strata);
        const Vec3d onwards = i > 0 ? between(path.points[i], path.points[i - 1]) : path.in.direction;
        const render::PathTurn turn = turn_at(vertex, onwards, false);
        if (i > 0) {
            light.turn(turn);
        } else if (!turn.is_delta) {
            const double drawn = is_hero_alone ? film.pdf[0] : film.shared_pdf(0);
            const double entrance = is_hero_alone ? path.in.pdf.hero : path.in.pdf.shared;
            weights.join = render::LightMisWeight::weight(light.others(turn),
                                                          drawn / (studio.camera().film_area_mm2() * entrance));
        }
        backwards = -1.0 * onwards;
    }
    return weights;
}

/// Rough metal, a mirror, rough glass, whose tables are made once.
struct Surfaces {
    scene::Material metal{scene::conductor_material(spectral::constant_spectrum(0.2, kGrid),
                                                    spectral::constant_spectrum(3.0, kGrid),
                                                    {.alpha_x = 0.3, .alpha_y = 0.3})};
    scene::Material mirror{scene::conductor_material(spectral::constant_spectrum(0.2, kGrid),
                                                     spectral::constant_spectrum(3.0, kGrid), {})};
    scene::Material glass{
        scene::dielectric_material(spectral::constant_spectrum(1.5, kGrid), {.alpha_x = 0.4, .alpha_y = 0.4})};
};

/// A room of matt, rough and mirroring things, under one light.
SceneParts room(int light, const Surfaces& surfaces) {
    SceneParts parts(kGrid);
    parts.add(scene::Quad{3000.0, 3000.0}, {.linear = about_x(180.0), .translation = {0.0, 0.0, 2200.0}}, 0.6);
    parts.add(scene::Sphere{200.0}, {.linear = kIdentity3, .translation = {150.0, 0.0, 1800.0}}, surfaces.metal);
    parts.add(scene::Quad{900.0, 900.0}, {.linear = about_y(90.0), .translation = {-500.0, 0.0, 1700.0}},
              surfaces.mirror);
    parts.add(scene::Sphere{150.0}, {.linear = kIdentity3, .translation = {-150.0, 200.0, 1800.0}}, surfaces.glass);
    const auto shines = [&](std::uint32_t object, bool both_sides) {
        parts.lights.emplace_back(scene::AreaLight{
            .object = object, .radiance = spectral::constant_spectrum(20.0, kGrid), .is_two_sided = both_sides});
    };
    const AffineMap above{.linear = about_x(90.0), .translation = {0.0, 600.0, 1500.0}};
    if (light == 0) {
        shines(parts.add(scene::Quad{300.0, 300.0}, above, 0.0), true);
    } else if (light == 1) {
        shines(parts.add(scene::Sphere{100.0}, above, 0.0), false);
    } else if (light == 2) {
        parts.lights.emplace_back(
            scene::SunLight{normalized(Vec3d{1.0, 2.0, -1.0}), 0.999, spectral::constant_spectrum(30.0, kGrid)});
    } else if (light == 3) {
        parts.lights.emplace_back(scene::ConstantLight{spectral::constant_spectrum(1.0, kGrid)});
    } else if (light == 4) {
        parts.lights.emplace_back(scene::PointLight{above.translation, spectral::constant_spectrum(1.0, kGrid)});
    } else {
        parts.lights.emplace_back(
            scene::SpotLight{above.translation, {0.0, -1.0, 0.0}, 0.5, -0.5, spectral::constant_spectrum(1.0, kGrid)});
    }
    return parts;
}

// What a camera path would have counted by running into the light, and by sampling it, and a light path by its joint,
// each computed by its own recursion from its own end, sum to one: of paths of one to four points over every kind of
// light, through the lens and every other camera. 1e-9: some dozens of roundings, in angles too, of points that lie
// 1e-12 beside each other.
TEST(MisWeight, WeightsOfAPathSumToOne) {
    const Surfaces surfaces;
    for (const render::LensModel model :
         {render::LensModel::exact, render::LensModel::exact_float, render::LensModel::pinhole,
          render::LensModel::thin_lens, render::LensModel::paraxial, render::LensModel::pinhole_profile,
          render::LensModel::thin_lens_profile, render::LensModel::polynomial}) {
        int counted = 0;
        int with_all = 0;
        for (int light = 0; light < 6; ++light) {
            SceneParts parts = room(light, surfaces);
            const Studio studio({.lens = "double-gauss-tronnier", .model = model, .sensor = kSensor, .grid = kGrid},
                                parts);
            for (std::uint32_t i = 0; i < 2000; ++i) {
                Numbers numbers(i);
                const spectral::PathWavelengths strata = kGrid.path(static_cast<int>(i % 16));
                const auto path = random_path(studio, strata, 1 + static_cast<int>(i % 4), numbers);
                const auto end = path ? end_of(studio.scene(), path->points.back(), strata, numbers) : std::nullopt;
                if (!end || !is_lit(studio.scene(), *path, end->sample.direction, strata)) {
                    continue;
                }
                const Weights weights = weights_of(studio, *path, *end, strata, i % 3 == 0);
                const double sum = weights.hit + weights.sample + weights.join;
                if (sum == 0.0) {
                    continue;  // a mirror sends light elsewhere than to a point
                }
                EXPECT_NEAR(sum, 1.0, 1e-9) << "light " << light << ", path " << i << ": " << weights.hit << ", "
                                            << weights.sample << ", " << weights.join;
                ++counted;
                with_all += std::min({weights.hit, weights.sample, weights.join}) > 1e-9 ? 1 : 0;
            }
        }
        EXPECT_GT(counted, 200);
        EXPECT_GT(with_all, 10);
    }
}

}  // namespace lensproof::mis_weight_test
