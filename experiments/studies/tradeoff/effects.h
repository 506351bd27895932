// experiments/studies/tradeoff/effects.h — what each effect of lens and light contributes to one picture, from a pilot
// render and a few thousand rays.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "engine/render/prepared_scene.h"
#include "experiments/studies/tradeoff/field_probe.h"
#include "experiments/studies/tradeoff/picture_error.h"

namespace lensproof::studies {

/// How far a picture is off, as a tolerance has it: px of the scene's own frame and EV, rms over it; mean CIEDE2000.
struct Contribution {
    Measured px;
    Measured ev;
    Measured ciede2000;
};

/// Something that a model may leave out.
struct Effect {
    std::string name;
    Contribution contribution;
    bool is_bound = false;  // the contribution is at most that
};

struct PilotSettings {
    int pixels = 2000;
    int samples = 16;  // of a pixel and a seed
    int seeds = 2;
    int points = 24;
    ProbeSettings probe{.rays = 96, .repetitions = 2};
    Cache cache{};
};

/// A small render with the full model, and what its camera does over the frame.
class Pilot {
  public:
    Pilot(const render::SceneSetup& setup, const PilotSettings& settings);

    /// Pictures of the pilot's size, a seed each from `first_seed` on, and a sample's time of one core, ns.
    struct Pictures {
        std::vector<formats::Image> rgb;
        double ns_per_sample = 0.0;
    };
    [[nodiscard]] Pictures render(const render::SceneSetup& setup, int first_seed) const;

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
    [[nodiscard]] std::size_t index(int x, int y) const {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(width()) + static_cast<std::size_t>(x);
    }
    void find_depth();

    render::SceneSetup setup_;
    render::SceneSetup small_;
    PilotSettings settings_;
    std::unique_ptr<render::Camera> camera_;
    std::vector<ProbePoint> points_;
    Pictures full_;
    std::vector<double> depth_;
};

/// What the full model has and a lens without it has not: distortion, lateral-colour, aberration-blur, axial-colour,
/// defocus, diffraction, vignetting, cos4, fresnel-loss, coating-colour, absorption, ghosts, faint-ghosts, barrel. Each
/// is done to the pilot's pictures, or taken from them. Pictures have much the same detail at every scale (Ruderman
/// 1994), so that a shift or a blur of so many of the scene's pixels is done to as many of the pilot's. Ghosts are
/// bounded by what pairs of surfaces reflect along the axis, as if all of it fell evenly on the film; of lamps outside
/// the frame that bound knows nothing. A barrel has a pass of its own.
std::vector<Effect> lens_effects(const Pilot& pilot);

/// What pictures are off by that differ in one thing and have the pilot's seeds.
Contribution difference(const Pilot& pilot, const std::vector<formats::Image>& without);

}  // namespace lensproof::studies
