#include "engine/render/integrators/passes.h"

#include <algorithm>
#include <stdexcept>

#include "engine/render/integrators/both_paths.h"
#include "engine/render/integrators/chart_tracer.h"

namespace lensproof::render {

namespace {

template <class Integrator>
TileRenderer renderer_by(const View& view) {
    return Integrator(view);
}

}  // namespace

Render Pass::render(const View& view) const {
    Render render{.film = view.camera->film(), .renderer = renderer(view)};
    render.film.has_splats = has_splats;
    render.film.has_features = view.has_features;
    return render;
}

const std::vector<Pass>& passes() {
    static const std::vector<Pass> all = {
        {"camera", "", false, renderer_by<PathTracer>},
        {"light", ", light paths", true, renderer_by<LightTracer>},
        {"both", ", camera and light paths", true, renderer_by<BothPaths>},
        {"chart", "", false, renderer_by<ChartTracer>},
    };
    return all;
}

const Pass& pass_named(const std::string& name) {
    const auto found = std::ranges::find(passes(), name, &Pass::name);
    if (found == passes().end()) {
        throw std::out_of_range("no pass is called " + name);
    }
    return *found;
}

}  // namespace lensproof::render
