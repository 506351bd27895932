#include "engine/render/prepared_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "engine/base/hash.h"
#include "engine/base/input_error.h"
#include "engine/render/integrators/chart_tracer.h"
#include "engine/render/stray/lights_in_lens.h"
#include "engine/scene/scene_build.h"

namespace lensproof::render {

namespace {

/// Complaints say that they are about it.
template <class... Arguments>
Camera made_camera(Arguments&&... arguments) {
    try {
        return Camera(std::forward<Arguments>(arguments)...);
    } catch (const InputError& error) {
        throw InputError(fmt::format("camera: {}", error.what()));
    }
}

}  // namespace

PreparedScene::PreparedScene(const SceneSetup& setup, const PixelFilter& filter, const Cache& cache,
                             PassIntegrators integrators, const std::optional<PixelFilter>& stray_filter,
                             std::shared_ptr<device::SharedDevice> device)
    : setup_(setup),
      filter_(filter),
      stray_filter_(stray_filter.value_or(filter)),
      cache_(cache),
      integrators_(setup.chart ? PassIntegrators{.usual = &integrator_named("chart")} : std::move(integrators)),
      camera_(made_camera(setup.camera, setup.spectral, filter, cache, integrators_.has_splats(), std::move(device))),
      world_(make_world()) {
    if (!camera_.clamp_note().empty()) {
        remarks_.push_back(camera_.clamp_note());
    }
}

World PreparedScene::make_world() {
    if (setup_.chart) {
        return even_chart(setup_.chart->chart, setup_.chart->placement, setup_.chart->luminance_cd_m2, camera_);
    }
    scene::BuiltScene built = scene::build_scene(setup_.scene, camera_.grid(), cache_);
    light_places_ = std::move(built.light_places);
    refuse_lights_in_lens(camera_, built.scene.lights, light_places_, integrators_.has_splats());
    remarks_ = std::move(built.remarks);
    return std::move(built.scene);
}

View PreparedScene::view(std::uint64_t seed, bool has_features) const {
    return {.world = &world_,
            .camera = &camera_,
            .seed = seed,
            .has_features = has_features,
            .paths = {.max_bounces = setup_.max_bounces},
            .diffraction = setup_.diffraction};
}

Render PreparedScene::render(std::uint64_t seed, bool has_features) const {
    return integrator().render(view(seed, has_features));
}

std::vector<Render> PreparedScene::render(const std::vector<std::string>& passes, std::uint64_t seed, bool has_features,
                                          bool guides_ghosts) {
    View straight = view(seed, has_features);
    straight.guides_ghosts = guides_ghosts;
    if (std::ranges::any_of(passes, [](const std::string& name) { return !pass_named(name).goes_straight; })) {
        straight.stray_camera = &stray_camera();
        refuse_near_lights(*straight.stray_camera);
    }
    return renders_of(passes, straight, integrators_);
}

EnergyAudit PreparedScene::audit(std::uint64_t seed, std::uint32_t paths) const {
    refuse_near_lights(camera_);
    return energy_audit(view(seed, false), paths);
}

void PreparedScene::refuse_near_lights(const Camera& camera) const {
    if (const auto* scene = std::get_if<scene::Scene>(&world_)) {
        refuse_lights_in_lens(camera, scene->lights, light_places_, true);
    }
}

const Camera& PreparedScene::stray_camera() {
    const bool has_lens = camera_.lens().has_value();
    const bool is_exact = traces_in_double(setup_.camera.model);
    if (!has_lens || (is_exact && stray_filter_.name() == filter_.name())) {
        return camera_;
    }
    if (!stray_camera_) {
        CameraSettings settings = is_exact ? setup_.camera : setup_.stray_camera.value_or(setup_.camera);
        settings.model = is_exact ? settings.model : LensModel::exact;
        settings.sensor = setup_.camera.sensor;
        stray_camera_.emplace(settings, setup_.spectral, stray_filter_, cache_, integrators_.has_splats());
    }
    return *stray_camera_;
}

std::string PreparedScene::camera_hash() const {
    return stray_camera_ ? hash_text(camera_.hash() + stray_camera_->hash()) : camera_.hash();
}

std::map<std::string, std::string> PreparedScene::metadata() const {
    std::map<std::string, std::string> metadata = camera_.metadata();
    if (std::holds_alternative<scene::Scene>(world_)) {
        metadata["lensproof:maxBounces"] = fmt::format("{}", setup_.max_bounces);
        if (setup_.scene.precision != scene::HitPrecision::in_double) {
            metadata["lensproof:precision"] = scene::name_of(setup_.scene.precision);
        }
        if (const double from = setup_.diffraction.smallest_airy; from != DiffractionSettings{}.smallest_airy) {
            metadata["lensproof:diffractedFromAiry"] = fmt::format("{}", from);
        }
    }
    return metadata;
}

}  // namespace lensproof::render
