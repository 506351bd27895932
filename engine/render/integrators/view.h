// engine/render/integrators/view.h — what an integrator renders.
#pragma once
#include <cstdint>
#include <variant>
#include <vector>

#include "engine/render/camera/camera.h"
#include "engine/render/film/film.h"
#include "engine/render/integrators/path_vertex.h"
#include "engine/render/stray/diffraction_settings.h"
#include "engine/scene/chart/chart.h"
#include "engine/scene/chart/pose.h"
#include "engine/scene/scene.h"

namespace lensproof::render {

/// A flat chart under even light. The world around it is as white as its white, in every direction.
struct EvenChart {
    scene::Chart chart;
    AffineMap pose;                      // of the chart, in the camera's frame
    std::vector<double> white_radiance;  // of a perfect white diffuser in its light, W·m⁻²·sr⁻¹·nm⁻¹, a stratum each
};

using World = std::variant<scene::Scene, EvenChart>;

/// What is seen, and by what. Held by pointer: they outlive the render.
struct View {
    const World* world = nullptr;
    const Camera* camera = nullptr;
    const Camera* stray_camera = nullptr;  // in which light goes astray; none: the camera
    std::uint64_t seed = 0;
    bool has_features = false;  // the film keeps depth, albedo and normals too
    /// Ghosts are searched for where they enter, which takes seconds for a lens; else at once, with more noise.
    bool guides_ghosts = true;
    PathSettings paths;
    DiffractionSettings diffraction;

    [[nodiscard]] const scene::Scene& scene() const { return std::get<scene::Scene>(*world); }
    [[nodiscard]] const EvenChart& chart() const { return std::get<EvenChart>(*world); }
};

/// Whether an integrator's paths make the image by themselves, or with those from the other end, one to each of these
/// of each pixel, each counted by its MIS weight (mis_weight.h).
enum class Combination { alone, weighed };

}  // namespace lensproof::render
