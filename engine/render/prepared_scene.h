// engine/render/prepared_scene.h — a scene file with everything loaded that its render needs.
#pragma once
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/cache.h"
#include "engine/optics/lens.h"
#include "engine/pupil/pupil_map.h"
#include "engine/render/sampling/pixel_filter.h"
#include "engine/render/scene_render.h"
#include "engine/render/scene_setup.h"
#include "engine/scene/scene_build.h"
#include "engine/spectral/sensor_response.h"

namespace lensproof::render {

/// Camera, lens and scene, ready for any number of renders. It stays where it was made: views refer to it.
class PreparedScene {
  public:
    /// Loads the lens and everything that the scene names. `cache`: for what is found by tracing the lens and for the
    /// uplift of RGB; the same pictures come from any. Throws InputError as `build_scene`, `camera_lens` and
    /// `gaussian_camera` do, and for a picture of more values than fit.
    PreparedScene(const SceneSetup& setup, const PixelFilter& filter, const Cache& cache);
    PreparedScene(const PreparedScene&) = delete;
    PreparedScene& operator=(const PreparedScene&) = delete;

    /// What `scene_renderer` renders.
    [[nodiscard]] SceneView view(std::uint64_t seed, bool has_features) const;

    /// The camera as the end of light paths; where their light enters a lens is found on the first call.
    [[nodiscard]] const CameraEnd& camera_end(const Cache& cache);

    [[nodiscard]] const scene::Scene& scene() const { return built_.scene; }

    /// What was repaired or left out, and that wavelengths were clamped to the glasses' range: a sentence each.
    [[nodiscard]] const std::vector<std::string>& remarks() const { return built_.remarks; }

    /// The lens's name; empty for cameras without one.
    [[nodiscard]] const std::string& lens_id() const { return lens_id_; }

    /// A hash of all that rays meet in the camera, at every wavelength.
    [[nodiscard]] std::string camera_hash() const;

    /// What a picture's file says of the camera, and the space of its R, G, B where they are not the camera's own.
    [[nodiscard]] std::map<std::string, std::string> metadata() const;
    [[nodiscard]] const std::optional<spectral::RgbSpace>& colours() const { return colours_; }

  private:
    [[nodiscard]] spectral::SpectralGrid make_grid();
    void make_exact_camera(const Cache& cache);
    void make_ideal_camera();

    SceneSetup setup_;
    PixelFilter filter_;
    std::optional<optics::Lens> lens_;
    std::string lens_id_;
    std::string clamp_note_;
    spectral::SpectralGrid grid_;
    scene::BuiltScene built_;
    std::unique_ptr<optics::SpectralLens<double>> traced_;
    std::unique_ptr<pupil::PupilMap> pupil_;
    std::unique_ptr<pupil::PupilSlices> slices_;
    std::unique_ptr<pupil::EntranceMap> entrance_map_;
    std::optional<CameraEnd> end_;
    SceneCamera camera_;
    std::vector<Vec3d> rgb_weights_;
    std::vector<Vec3d> albedo_weights_;
    std::optional<spectral::RgbSpace> colours_;
};

}  // namespace lensproof::render
