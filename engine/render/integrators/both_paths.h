// engine/render/integrators/both_paths.h — camera paths and light paths together.
#pragma once
#include "engine/render/integrators/light_tracer.h"
#include "engine/render/integrators/path_tracer.h"

namespace lensproof::render {

/// Renders a scene by a camera path and a light path for each sample of each pixel, weighed by how well each makes what
/// they find (mis_weight.h): what glass gathers comes by light paths, what mirrors show by camera paths, and all else
/// by both. With --noise some pixels have fewer of either; weights stay those of one for one, and sum to one. A
/// TileRenderer.
class BothPaths {
  public:
    explicit BothPaths(const View& view)
        : camera_(view, Combination::weighed), light_(light_tracer(view, Combination::weighed)) {}

    void operator()(const TileSamples& samples, FilmTile& tile) {
        camera_(samples, tile);
        light_(samples, tile);
    }

  private:
    PathTracer camera_;
    TileRenderer light_;
};

}  // namespace lensproof::render
