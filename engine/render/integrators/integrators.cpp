#include "engine/render/integrators/integrators.h"

#include <algorithm>
#include <stdexcept>

#include "engine/render/integrators/both_paths.h"
#include "engine/render/integrators/chart_tracer.h"

namespace lensproof::render {

namespace {

template <class Renderer>
TileRenderer renderer_by(const View& view) {
    return Renderer(view);
}

}  // namespace

Render Integrator::render(const View& view) const {
    Render render{.film = view.camera->film(), .renderer = renderer(view)};
    render.film.has_splats = has_splats;
    render.film.has_features = view.has_features;
    return render;
}

const std::vector<Integrator>& integrators() {
    static const std::vector<Integrator> all = {
        {"camera", "", false, renderer_by<PathTracer>},
        {"light", ", light paths", true, [](const View& view) { return light_tracer(view); }},
        {"both", ", camera and light paths", true, renderer_by<BothPaths>},
        {"chart", "", false, renderer_by<ChartTracer>},
    };
    return all;
}

const Integrator& integrator_named(const std::string& name) {
    const auto found = std::ranges::find(integrators(), name, &Integrator::name);
    if (found == integrators().end()) {
        throw std::out_of_range("no integrator is called " + name);
    }
    return *found;
}

}  // namespace lensproof::render
