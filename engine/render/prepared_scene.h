// engine/render/prepared_scene.h — a scene file with everything loaded that its render needs.
#pragma once
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/cache.h"
#include "engine/render/integrators/energy_audit.h"
#include "engine/render/integrators/passes.h"
#include "engine/render/progressive.h"
#include "engine/render/scene_setup.h"

namespace lensproof::render {

/// Camera and world, ready for any number of renders. It stays where it was made: views refer to it.
class PreparedScene {
  public:
    /// Loads the lens and everything that the scene names. `integrators`: of a chart in even light there is but one.
    /// `cache`: for what is found by tracing the lens and for the uplift of RGB; the same pictures come from any.
    /// `stray_filter`: of passes that do not go straight, in place of `filter`. `device`: for the camera, or null.
    /// Throws InputError as `Camera` and `build_scene` do.
    PreparedScene(const SceneSetup& setup, const PixelFilter& filter, const Cache& cache,
                  PassIntegrators integrators = {}, const std::optional<PixelFilter>& stray_filter = {},
                  std::shared_ptr<device::SharedDevice> device = nullptr);
    PreparedScene(const PreparedScene&) = delete;
    PreparedScene& operator=(const PreparedScene&) = delete;

    [[nodiscard]] Render render(std::uint64_t seed, bool has_features) const;
    /// What passes have of that, by their names (renders_of): light goes astray in the lens itself, whatever model of
    /// it makes the image. Throws InputError where the camera has no such light, for a light that is nearer to the lens
    /// than such light is drawn (refuse_lights_in_lens), and as `Camera` does.
    [[nodiscard]] std::vector<Render> render(const std::vector<std::string>& passes, std::uint64_t seed,
                                             bool has_features, bool guides_ghosts = true);

    /// Where the light goes that comes into the camera. Throws InputError where that is not known (FateEntrance), and
    /// for a light that is too near.
    [[nodiscard]] EnergyAudit audit(std::uint64_t seed, std::uint32_t paths) const;

    [[nodiscard]] const Camera& camera() const { return camera_; }
    /// Of all that rays have met in cameras, in any render so far.
    [[nodiscard]] std::string camera_hash() const;
    [[nodiscard]] const Integrator& integrator() const { return *integrators_.usual; }

    /// What was repaired or left out, and that wavelengths were clamped to the glasses' range: a sentence each.
    [[nodiscard]] const std::vector<std::string>& remarks() const { return remarks_; }

    /// What a picture's file says of camera and paths.
    [[nodiscard]] std::map<std::string, std::string> metadata() const;

  private:
    [[nodiscard]] View view(std::uint64_t seed, bool has_features) const;
    [[nodiscard]] World make_world();
    void refuse_near_lights(const Camera& camera) const;
    [[nodiscard]] const Camera& stray_camera();

    SceneSetup setup_;
    PixelFilter filter_;
    PixelFilter stray_filter_;
    Cache cache_;
    PassIntegrators integrators_;
    Camera camera_;
    std::optional<Camera> stray_camera_;  // where it is another, once a pass has asked for it
    std::vector<std::string> remarks_;
    std::vector<std::string> light_places_;  // as BuiltScene has them
    World world_;
};

}  // namespace lensproof::render
