#include "engine/render/integrators/passes.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "engine/base/input_error.h"
#include "engine/render/integrators/ghost_paths.h"
#include "engine/render/stray/diffracted_entrance.h"
#include "engine/render/stray/ghost_entrance.h"
#include "engine/render/stray/wave_entrance.h"

namespace lensproof::render {

namespace {

Render imaged(const View& view, const Integrator& integrator) {
    View scattered = view;
    scattered.paths.min_bounces = 1;
    return integrator.render(scattered);
}

Render straight(const View& view, const Integrator& integrator) {
    return integrator.render(view);
}

Render direct(const View& view, const Integrator& integrator) {
    View seen = view;
    seen.paths.max_bounces = 0;
    seen.has_features = false;
    return integrator.render(seen);
}

Render with_splats(const View& view, TileRenderer renderer) {
    Render render{.film = view.camera->film(), .renderer = std::move(renderer)};
    render.film.has_splats = true;
    return render;
}

/// By light paths from all that shines on the camera.
template <class Entrance>
Render astray(const View& view, Entrance entrance, std::uint64_t salt, LightPathsKept kept = LightPathsKept::all) {
    Render render = with_splats(view, LightPaths(view, std::move(entrance), salt, kept));
    render.lands_anywhere = true;
    return render;
}

Render by_chance(const View& view, StrayClass wanted, std::uint64_t salt) {
    return with_splats(view, StrayPaths(view, wanted, salt));
}

Render ghosts(const View& view, const Integrator& /*integrator*/) {
    constexpr std::uint64_t kOfGhosts = 0x3c6ef372fe94f82bULL;
    GhostEntrance entrance(*view.camera, view.guides_ghosts);
    return has_mirrors(view.scene()) ? with_splats(view, GhostPaths(view, entrance, kOfGhosts))
                                     : astray(view, std::move(entrance), kOfGhosts);
}

Render faint_ghosts(const View& view, const Integrator& /*integrator*/) {
    return by_chance(view, StrayClass::many_reflections, 0x9b05688c2b3e6c1fULL);
}

Render barrel(const View& view, const Integrator& /*integrator*/) {
    return by_chance(view, StrayClass::walls, 0x1f83d9abfb41bd6bULL);
}

Render diffracted(const View& view, const Integrator& /*integrator*/) {
    return astray(view, DiffractedEntrance(*view.camera, view.diffraction), 0x510e527fade682d1ULL);
}

Render waves(const View& view, const Integrator& /*integrator*/) {
    const std::vector<scene::SunLight> suns = view.scene().lights.suns();
    if (suns.empty()) {
        throw InputError("the pass \"waves\" images suns, and the scene has none");
    }
    return astray(view, WaveEntrance(*view.camera, suns, view.diffraction), 0x9159015a3070dd17ULL,
                  LightPathsKept::of_suns);
}

Render everything(const View& view, const Integrator& /*integrator*/) {
    return astray(view, WalkEntrance(*view.camera, StrayClass::all), 0xa54ff53a5f1d36f1ULL);
}

}  // namespace

const std::vector<Pass>& passes() {
    static const std::vector<Pass> all = {
        {"imaged", "the scene through the lens", imaged, true},
        {"direct", "lights as they are seen", direct, true},
        {"ghosts", "light that two surfaces of the lens reflect", ghosts},
        {"faint-ghosts", "light that is reflected four times and more", faint_ghosts},
        {"barrel", "light that the inside of the lens scatters, and dust on its front", barrel},
        {"diffracted", "light that the edges of the stop turn aside: halos and streaks", diffracted},
        {"waves",
         "suns, imaged and diffracted by waves: in the place of what \"direct\" and \"diffracted\" have of them",
         waves},
        {"straight", "imaged and direct, by the same paths: half the time of the two", straight, true, true},
        {"everything", "all of these but diffracted and waves at once, by chance: slow, and a judge of them",
         everything, false, true},
    };
    return all;
}

std::string pass_conflict(const std::vector<std::string>& names) {
    const auto count = [&](const std::string& name) { return std::ranges::count(names, name); };
    for (const std::string& name : names) {
        if (count(name) > 1) {
            return fmt::format("names {} twice, expected each once", name);
        }
    }
    if (count("everything") > 0 && names.size() > 1) {
        return "has everything beside others, of which it is the sum; expected it alone";
    }
    if (count("straight") > 0 && count("imaged") + count("direct") > 0) {
        return "has straight beside imaged or direct, which it is the sum of; expected it in their place";
    }
    return {};
}

const Pass& pass_named(const std::string& name) {
    const auto found = std::ranges::find(passes(), name, &Pass::name);
    if (found == passes().end()) {
        throw std::out_of_range("no pass is called " + name);
    }
    return *found;
}

const Integrator& PassIntegrators::of(const std::string& pass) const {
    const auto own = of_pass.find(pass);
    return own == of_pass.end() ? *usual : *own->second;
}

bool PassIntegrators::has_splats() const {
    return usual->has_splats || std::ranges::any_of(of_pass, [](const auto& own) { return own.second->has_splats; });
}

std::vector<Render> renders_of(const std::vector<std::string>& names, const View& view,
                               const PassIntegrators& integrators) {
    const bool is_diffracted = std::ranges::find(names, "diffracted") != names.end();
    View stray = view;
    stray.camera = view.stray_camera != nullptr ? view.stray_camera : view.camera;
    const double straight =
        is_diffracted ? DiffractedEntrance(*stray.camera, view.diffraction).geometric_fraction() : 1.0;
    const bool has_waves = std::ranges::find(names, "waves") != names.end();
    std::vector<Render> renders;
    for (const std::string& name : names) {
        const Pass& pass = pass_named(name);
        View seen = pass.goes_straight ? view : stray;
        seen.paths.leaves_suns_out = has_waves && (pass.goes_straight || name == "diffracted");
        renders.push_back(pass.render(seen, integrators.of(name)));
        renders.back().film.kept_fraction = pass.goes_straight ? straight : 1.0;
    }
    double bytes = 0.0;
    for (const Render& render : renders) {
        const FilmLayout& film = render.film;
        bytes += static_cast<double>(film_bytes_per_pixel(film)) * film.width * film.height;
    }
    if (renders.size() > 1 && bytes > kMostFilmBytes) {
        throw InputError(
            fmt::format("{} passes need {:.1f} GB of films, expected {:.0f} GB at most: fewer passes, "
                        "pixels or layers",
                        renders.size(), bytes / 1e9, kMostFilmBytes / 1e9));
    }
    return renders;
}

}  // namespace lensproof::render
