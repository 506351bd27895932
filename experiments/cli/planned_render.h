// experiments/cli/planned_render.h — a plan for a scene's render, for the commands that ask for one.
#pragma once
#include <string>

#include "experiments/cli/command.h"
#include "experiments/studies/tradeoff/plan.h"

namespace lensproof::cli {

/// Throws InputError naming what is wrong with the tolerance, or the scene.
studies::Plan plan_of(const render::SceneSetup& setup, const std::string& scene, const std::string& tolerance,
                      const CommonOptions& common);

/// What is to be rendered, in a line; and what it would take where the scene's samples leave more noise than is
/// tolerated.
std::string plan_text(const studies::Plan& plan);

}  // namespace lensproof::cli
