#include "engine/render/scene_render.h"

#include <cmath>
#include <memory>

#include "engine/render/tile_paths.h"
#include "engine/scene/pose.h"

namespace lensproof {

namespace {

bool is_achromatic(const SceneCamera& camera) {
    const auto* ideal = std::get_if<std::vector<GaussianCamera>>(&camera);
    return ideal != nullptr && std::ranges::all_of(*ideal, [&](const GaussianCamera& at) {
               GaussianCamera like = at;
               like.transmittance = ideal->front().transmittance;
               return like == ideal->front();
           });
}

class SceneTileRenderer {
  public:
    explicit SceneTileRenderer(const SceneView& view)
        : view_(view), producer_(make_producer(view)), is_achromatic_(is_achromatic(*view.camera)) {}

    void operator()(const TileSamples& samples, FilmTile& tile) {
        std::visit(
            [&](auto& producer) {
                for_each_path(samples, view_.sensor.width, producer, paths_, tile,
                              [&](int path, std::size_t pixel) { add_path(path, pixel, tile); });
            },
            producer_);
    }

  private:
    using Producer = std::variant<CameraPathProducer<double>, IdealPathProducer>;

    static Producer make_producer(const SceneView& view) {
        if (const auto* exact = std::get_if<ExactCamera>(view.camera)) {
            return CameraPathProducer<double>({.sensor = view.sensor,
                                               .lens = exact->lens,
                                               .pupil = exact->pupil,
                                               .seed = view.seed,
                                               .filter = view.film.filter});
        }
        return IdealPathProducer({.sensor = view.sensor,
                                  .at = &std::get<std::vector<GaussianCamera>>(*view.camera),
                                  .seed = view.seed,
                                  .filter = view.film.filter});
    }

    void add_path(int path, std::size_t pixel, FilmTile& tile) {
        const auto at = static_cast<std::size_t>(path);
        const Ray<double> in_lens = paths_.ray(path);
        const Ray<double> ray{view_.pose.to_world(camera_to_lens(in_lens.origin)),
                              view_.pose.direction_to_world(camera_to_lens(in_lens.direction))};
        const PathWavelengths strata = view_.scene->grid.path(paths_.wavelength[at]);
        PathSampler numbers(view_.seed, paths_.pixel[at], paths_.sample[at]);
        const SpectralSample one(1.0F);
        const PathRadiance found =
            trace_path(*view_.scene, ray, strata, is_achromatic_ ? one : hero_alone(one), view_.paths, numbers);
        tile.count_rays(found.rays);
        if (is_achromatic_) {
            add_all(pixel, at, strata, found.radiance, tile);
        } else {
            tile.add(pixel, paths_.sample[at], strata.index[0], found.radiance[0] * paths_.weight[at]);
        }
        if (view_.film.has_features && found.first) {
            add_features(pixel, strata, *found.first, tile);
        }
    }

    /// A path's weight is its hero's; the others pass the camera by their own transmittance.
    void add_all(std::size_t pixel, std::size_t path, const PathWavelengths& strata, const SpectralSample& radiance,
                 FilmTile& tile) const {
        const auto& cameras = std::get<std::vector<GaussianCamera>>(*view_.camera);
        const double per_transmittance = paths_.weight[path] / cameras[strata.index[0]].transmittance;
        std::array<float, kWavelengthsPerPath> irradiance{};
        for (std::size_t i = 0; i < irradiance.size(); ++i) {
            irradiance[i] =
                static_cast<float>(per_transmittance * cameras[strata.index[i]].transmittance * radiance[i]);
        }
        tile.add(pixel, paths_.sample[path], strata.index, irradiance);
    }

    void add_features(std::size_t pixel, const PathWavelengths& strata, const FirstSurface& first,
                      FilmTile& tile) const {
        Vec3d albedo;
        const double share = is_achromatic_ ? 1.0 / kWavelengthsPerPath : 1.0;
        for (std::size_t i = 0; i < (is_achromatic_ ? kWavelengthsPerPath : 1); ++i) {
            albedo = albedo + share * first.albedo[i] * view_.albedo_weights[strata.index[i]];
        }
        tile.add_features(pixel, {.depth_mm = view_.pose.to_camera(first.point).z,
                                  .albedo_rgb = albedo,
                                  .normal = view_.pose.direction_to_camera(first.normal)});
    }

    SceneView view_;
    Producer producer_;
    CameraPathBuffer<double> paths_;
    bool is_achromatic_;
};

}  // namespace

TileRenderer scene_renderer(const SceneView& view) {
    // On the heap, since std::function wants to be able to copy what it holds.
    return [renderer = std::make_shared<SceneTileRenderer>(view)](const TileSamples& samples, FilmTile& tile) {
        (*renderer)(samples, tile);
    };
}

}  // namespace lensproof
