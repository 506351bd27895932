#include "engine/render/scene_render.h"

#include <algorithm>
#include <array>
#include <memory>
#include <utility>

#include "engine/render/light_tracer.h"
#include "engine/render/shared_rays.h"
#include "engine/render/tile_paths.h"

namespace lensproof::render {

namespace {

/// What a path counts at each of its wavelengths, sr, the mean over them being the sample.
using PathWeights = std::array<float, spectral::kWavelengthsPerPath>;

PathWeights hero_alone(double weight) {
    return {static_cast<float>(spectral::kWavelengthsPerPath * weight)};
}

/// Through the lens itself.
class ExactPaths {
  public:
    ExactPaths(const SceneView& view, const ExactCamera& camera)
        : producer_({.sensor = view.sensor,
                     .lens = camera.lens,
                     .pupil = camera.pupil,
                     .seed = view.seed,
                     .filter = view.film.filter}),
          shared_(view.scene->grid, *camera.lens, *camera.pupil, view.sensor, view.film.filter.is_box()),
          is_shared_(view.film.filter.is_box()) {}

    CameraPathProducer<double>& producer() { return producer_; }
    void weigh(const CameraPathBuffer<double>& paths, bool needs_densities) {
        if (is_shared_ || needs_densities) {
            const auto& weights = shared_.weigh(paths);
            weights_ = is_shared_ ? &weights : nullptr;
        }
    }
    [[nodiscard]] PathDensity density(std::size_t path, const CameraEnd& /*end*/, const Ray<double>& /*out*/,
                                      const spectral::PathWavelengths& /*strata*/) const {
        return shared_.densities()[path];
    }
    [[nodiscard]] PathWeights weights(const CameraPathBuffer<double>& paths, std::size_t path,
                                      const spectral::PathWavelengths& /*strata*/) const {
        return weights_ != nullptr ? (*weights_)[path] : hero_alone(paths.weight[path]);
    }

  private:
    CameraPathProducer<double> producer_;
    SharedRays shared_;
    bool is_shared_;  // with wider filters, which draw film points unevenly, the hero stays alone
    const std::vector<PathWeights>* weights_ = nullptr;
};

/// Through ideal cameras. One whose colours take one way carries all wavelengths.
class IdealPaths {
  public:
    IdealPaths(const SceneView& view, const std::vector<GaussianCamera>& cameras)
        : producer_({.sensor = view.sensor, .at = &cameras, .seed = view.seed, .filter = view.film.filter}),
          cameras_(&cameras),
          is_achromatic_(std::ranges::all_of(cameras, [&](GaussianCamera like) {
              like.transmittance = cameras.front().transmittance;
              return like == cameras.front();
          })) {}

    IdealPathProducer& producer() { return producer_; }
    void weigh(const CameraPathBuffer<double>& /*paths*/, bool /*needs_densities*/) {}
    [[nodiscard]] static PathDensity density(std::size_t /*path*/, const CameraEnd& end, const Ray<double>& out,
                                             const spectral::PathWavelengths& strata) {
        const FilmArrival film = end.arrive({out.origin, -1.0 * out.direction}, strata);
        return {.shared = film.shared_density(0), .hero = film.drawn[0]};
    }
    /// A path's weight is its hero's; the others pass the camera by their own transmittance.
    [[nodiscard]] PathWeights weights(const CameraPathBuffer<double>& paths, std::size_t path,
                                      const spectral::PathWavelengths& strata) const {
        if (!is_achromatic_) {
            return hero_alone(paths.weight[path]);
        }
        const double per_transmittance = paths.weight[path] / (*cameras_)[strata.index[0]].transmittance;
        PathWeights weights{};
        for (std::size_t i = 0; i < weights.size(); ++i) {
            weights[i] = static_cast<float>(per_transmittance * (*cameras_)[strata.index[i]].transmittance);
        }
        return weights;
    }

  private:
    IdealPathProducer producer_;
    const std::vector<GaussianCamera>* cameras_;
    bool is_achromatic_;
};

template <class Paths>
class SceneTileRenderer {
  public:
    /// `end`: for paths that share their work with light paths; else null.
    SceneTileRenderer(const SceneView& view, Paths paths, const CameraEnd* end)
        : view_(view), paths_(std::move(paths)), end_(end) {}

    void operator()(const TileSamples& samples, FilmTile& tile) {
        for_each_path(
            samples, view_.sensor.width, paths_.producer(), buffer_, tile,
            [&] { paths_.weigh(buffer_, end_ != nullptr); },
            [&](int path, std::size_t pixel) { add_path(static_cast<std::size_t>(path), pixel, tile); });
    }

  private:
    void add_path(std::size_t path, std::size_t pixel, FilmTile& tile) {
        const Ray<double> in_lens = buffer_.ray(static_cast<int>(path));
        const Ray<double> ray{scene::moved(view_.camera_to_world, scene::camera_to_lens(in_lens.origin)),
                              scene::rotate(view_.camera_to_world, scene::camera_to_lens(in_lens.direction))};
        const spectral::PathWavelengths strata = view_.scene->grid.path(buffer_.wavelength[path]);
        PathSampler numbers(view_.seed, buffer_.pixel[path], buffer_.sample[path]);
        DrawnByCamera drawn{.end = end_, .ray = in_lens, .density = {}};
        if (end_ != nullptr) {
            drawn.density = paths_.density(path, *end_, in_lens, strata);
        }
        const PathRadiance found =
            trace_path(*view_.scene, ray, strata, view_.paths, numbers, end_ != nullptr ? &drawn : nullptr);
        tile.count_rays(found.rays);
        PathWeights irradiance = paths_.weights(buffer_, path, strata);
        for (std::size_t i = 0; i < irradiance.size(); ++i) {
            irradiance[i] *= found.radiance[i];
        }
        irradiance[0] += hero_alone(buffer_.weight[path])[0] * found.hero_radiance;
        tile.add(pixel, buffer_.sample[path], strata.index, irradiance);
        if (view_.film.has_features && found.first) {
            add_features(pixel, strata, *found.first, tile);
        }
    }

    void add_features(std::size_t pixel, const spectral::PathWavelengths& strata, const FirstSurface& first,
                      FilmTile& tile) const {
        Vec3d albedo;
        for (std::size_t i = 0; i < spectral::kWavelengthsPerPath; ++i) {
            albedo = albedo +
                     (first.albedo[i] / double{spectral::kWavelengthsPerPath}) * view_.albedo_weights[strata.index[i]];
        }
        tile.add_features(pixel, {.depth_mm = scene::moved_back(view_.camera_to_world, first.point).z,
                                  .albedo_rgb = albedo,
                                  .normal = scene::rotate_back(view_.camera_to_world, first.normal)});
    }

    SceneView view_;
    Paths paths_;
    const CameraEnd* end_;
    CameraPathBuffer<double> buffer_;
};

TileRenderer camera_path_renderer(const SceneView& view, const CameraEnd* end) {
    // On the heap, since std::function wants to be able to copy what it holds.
    const auto renderer_by = [&](auto paths) -> TileRenderer {
        auto renderer = std::make_shared<SceneTileRenderer<decltype(paths)>>(view, std::move(paths), end);
        return [renderer](const TileSamples& samples, FilmTile& tile) { (*renderer)(samples, tile); };
    };
    if (const auto* exact = std::get_if<ExactCamera>(view.camera)) {
        return renderer_by(ExactPaths(view, *exact));
    }
    return renderer_by(IdealPaths(view, std::get<std::vector<GaussianCamera>>(*view.camera)));
}

/// Light paths have numbers of their own: those of camera paths of the same sample would go with them.
std::uint64_t seed_of_light_paths(std::uint64_t seed) {
    return sampler_detail::mixed(seed ^ 0xbb67ae8584caa73bULL);
}

TileRenderer light_renderer(const SceneView& view, const CameraEnd& end, LightPaths paths) {
    return [view, &end, paths, seed = seed_of_light_paths(view.seed)](const TileSamples& samples, FilmTile& tile) {
        const PixelRect& rect = samples.rect;
        const int wavelengths = view.scene->grid.size();
        for (int y = rect.y; y < rect.y + rect.height; ++y) {
            for (int x = rect.x; x < rect.x + rect.width; ++x) {
                const auto pixel = static_cast<std::uint32_t>(y * view.sensor.width + x);
                for (std::uint32_t sample = samples.first; sample < samples.end; ++sample) {
                    PathSampler numbers(seed, pixel, sample);
                    const spectral::PathWavelengths strata =
                        view.scene->grid.path(static_cast<int>(numbers.next()[0] * wavelengths));
                    tile.begin_light_path();
                    tile.count_rays(trace_light_path(*view.scene, end, strata, view.paths, numbers, tile, paths));
                }
            }
        }
    };
}

}  // namespace

TileRenderer scene_renderer(const SceneView& view) {
    return camera_path_renderer(view, nullptr);
}

TileRenderer light_path_renderer(const SceneView& view, const CameraEnd& end) {
    return light_renderer(view, end, LightPaths::alone);
}

TileRenderer both_paths_renderer(const SceneView& view, const CameraEnd& end) {
    return
        [camera = camera_path_renderer(view, &end), light = light_renderer(view, end, LightPaths::with_camera_paths)](
            const TileSamples& samples, FilmTile& tile) {
            camera(samples, tile);
            light(samples, tile);
        };
}

}  // namespace lensproof::render
