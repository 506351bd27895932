// experiments/studies/tradeoff/pilot.h — a small render of a scene with the full model, from which plans are made.
#pragma once
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "engine/render/prepared_scene.h"
#include "experiments/studies/tradeoff/field_probe.h"

namespace lensproof::studies {

struct PilotSettings {
    int pixels = 2000;
    int samples = 16;            // of a pixel and a seed
    int stray_samples = 8;       // the same, of light that goes astray
    int smooth_pixels = 60'000;  // of what tells how smooth stray light is (smooth_light.h)
    int few_smooth_samples = 2;  // of a pixel and a seed
    int smooth_samples = 4;      // where these do not tell
    int seeds = 2;
    int points = 24;
    ProbeSettings probe{.rays = 24, .even_rays = 128, .repetitions = 8};
    Cache cache{};
};

/// A small render with the full model, and what its camera does over the frame.
class Pilot {
  public:
    Pilot(const render::SceneSetup& setup, const PilotSettings& settings);

    /// Pictures of the pilot's size, a seed each, and what a sample takes of one core, ns: of all passes together, and
    /// of those of stray light.
    struct Pictures {
        std::vector<formats::Image> rgb;
        double ns_per_sample = 0.0;
        std::map<std::string, double> stray_ns = {};
    };
    /// Of what goes straight, and of stray light in these passes, with seeds from `first_seed` on; ghosts without a
    /// search for where they enter, so noisier and quicker than a render's. Throws InputError
    /// where the camera has no such light.
    [[nodiscard]] Pictures render(const render::SceneSetup& setup, const std::vector<std::string>& stray_passes,
                                  int first_seed) const;
    /// The full model's pictures with the light of one of its passes, likewise; the time is that of the pass alone.
    [[nodiscard]] Pictures with_pass(const std::string& pass) const;
    /// Why the full model's camera has no light in a pass; else empty.
    [[nodiscard]] std::string why_no_pass(const std::string& pass) const;
    /// Whether light can go astray at all: not of charts in an even world, nor among mirrors.
    [[nodiscard]] bool has_passes() const { return !setup_.chart && !camera_->lens()->has_mirrors(); }

    [[nodiscard]] const render::SceneSetup& setup() const { return setup_; }
    [[nodiscard]] const PilotSettings& settings() const { return settings_; }
    [[nodiscard]] const Pictures& full() const { return full_; }
    [[nodiscard]] const render::Camera& camera() const { return *camera_; }  // exact, at the scene's own pixels
    [[nodiscard]] const std::vector<ProbePoint>& points() const { return points_; }
    /// Root mean square of the pilot's relative noise, a pixel's, with one sample.
    [[nodiscard]] double noise_of_sample() const;

    /// Along the camera's axis, mm; NaN where there is nothing.
    [[nodiscard]] double depth_mm(int x, int y) const { return depth_[index(x, y)]; }
    /// Of the pilot's pixel: from the axis, in half-diagonals, and in which direction.
    [[nodiscard]] double image_height(int x, int y) const;
    [[nodiscard]] Vec2d outwards(int x, int y) const;
    [[nodiscard]] int width() const { return small_.camera.sensor.width; }
    [[nodiscard]] int height() const { return small_.camera.sensor.height; }

  private:
    /// A seed's picture, its time being added to that of a sample.
    [[nodiscard]] formats::Image picture(const render::Render& render, int samples, double& ns_per_sample) const;
    [[nodiscard]] std::size_t index(int x, int y) const {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(width()) + static_cast<std::size_t>(x);
    }
    void find_depth();

    render::SceneSetup setup_;
    render::SceneSetup small_;
    PilotSettings settings_;
    std::unique_ptr<render::Camera> camera_;
    std::vector<ProbePoint> points_;
    std::unique_ptr<render::PreparedScene> scene_;  // of the pilot's size
    Pictures full_;
    std::vector<double> depth_;
};

}  // namespace lensproof::studies
