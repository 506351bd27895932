// experiments/studies/cameras/simulations.h — [[simulations]]: charts rendered through lenses, measured as photos are,
// and held against the lenses' own rays.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "calibration/geometry/camera_model.h"
#include "engine/render/camera/camera.h"
#include "engine/render/scene_setup.h"
#include "experiments/findings/study.h"
#include "experiments/studies/cameras/measured_camera.h"
#include "experiments/studies/cameras/reference_curves.h"

namespace lensproof::studies {

/// A simulated camera, the views of a chart that it renders, and its limits.
struct Simulation {
    std::string name;
    render::SceneSetup scene;  // the camera and an evenly lit chart, which stands where the views say
    std::vector<scene::Placement> views;
    bool flat_field = true;
    int flat_field_samples_per_pixel = 128;  // an even field shows the noise that edges hide
    std::optional<calibration::ModelKind> model;
    calibration::WantedParts parts;
    ClosedLoopLimits limits;
    std::vector<ReferenceSource> references;
    // What the file states of it, for steps to be known by.
    Json stated_scene{};  // camera, chart, light, sampling
    Json stated_views = Json::list();
};

/// Also takes [light] and [render], which they share.
std::vector<Simulation> simulations_of(findings::ExperimentFile& file);

/// Renders the views with the simulation's camera and measures them.
MeasuredCamera measure_simulation(const Simulation& simulation, const render::Camera& camera,
                                  const findings::RunSettings& settings, const findings::RunProgress& progress);

std::vector<findings::Study> read_simulations(findings::ExperimentFile& file);

}  // namespace lensproof::studies
