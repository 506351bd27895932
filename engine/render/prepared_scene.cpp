#include "engine/render/prepared_scene.h"

#include <fmt/format.h>

#include <utility>

#include "engine/render/integrators/chart_tracer.h"
#include "engine/scene/scene_build.h"

namespace lensproof::render {

PreparedScene::PreparedScene(const SceneSetup& setup, const PixelFilter& filter, const Cache& cache,
                             const Integrator& integrator)
    : integrator_(setup.chart ? &integrator_named("chart") : &integrator),
      camera_(setup.camera, setup.spectral, filter, cache, integrator_->has_splats),
      max_bounces_(setup.max_bounces),
      world_(make_world(setup, cache)) {
    if (!camera_.clamp_note().empty()) {
        remarks_.push_back(camera_.clamp_note());
    }
}

World PreparedScene::make_world(const SceneSetup& setup, const Cache& cache) {
    if (setup.chart) {
        return even_chart(setup.chart->chart, setup.chart->placement, setup.chart->luminance_cd_m2, camera_);
    }
    scene::BuiltScene built = scene::build_scene(setup.scene, camera_.grid(), cache);
    remarks_ = std::move(built.remarks);
    return std::move(built.scene);
}

View PreparedScene::view(std::uint64_t seed, bool has_features) const {
    return {.world = &world_,
            .camera = &camera_,
            .seed = seed,
            .has_features = has_features,
            .paths = {.max_bounces = max_bounces_}};
}

Render PreparedScene::render(std::uint64_t seed, bool has_features) const {
    return integrator_->render(view(seed, has_features));
}

std::vector<Render> PreparedScene::render(const std::vector<std::string>& passes, std::uint64_t seed,
                                          bool has_features) const {
    return renders_of(passes, view(seed, has_features), *integrator_);
}

std::map<std::string, std::string> PreparedScene::metadata() const {
    std::map<std::string, std::string> metadata = camera_.metadata();
    if (std::holds_alternative<scene::Scene>(world_)) {
        metadata["lensproof:maxBounces"] = fmt::format("{}", max_bounces_);
    }
    return metadata;
}

}  // namespace lensproof::render
