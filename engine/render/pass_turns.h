// engine/render/pass_turns.h — passes that add up to a picture, side by side.
#pragma once
#include <span>

#include "engine/render/progressive.h"

namespace lensproof::render {

/// `render_progressively` of passes that add up to a picture, in turns of a round: each time the pass goes on by which
/// the picture's relative variance falls most for a sample, but all of them until they have kFewestSamplesToJudge. A
/// pass whose light lands anywhere goes on in all tiles where one is not good yet. As many renders as states.
RenderEnd render_passes(std::span<RenderState> states, std::span<const Render> renders, const RenderGoal& goal,
                        const RenderControl& control);

}  // namespace lensproof::render
