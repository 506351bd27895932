// experiments/cli/render_command.cpp — `lensproof render SCENE`: a scene, or a chart, through a lens.
#include <fmt/format.h>

#include <memory>
#include <utility>

#include "engine/base/cache.h"
#include "engine/base/file.h"
#include "engine/base/hash.h"
#include "engine/base/input_error.h"
#include "engine/render/camera.h"
#include "engine/render/prepared_scene.h"
#include "experiments/cli/raw_files.h"
#include "experiments/cli/render_job.h"

namespace lensproof::cli {

namespace {

/// What a pixel sees: the filter asked for, or what the scene's sensor says.
render::PixelFilter filter_of(const std::optional<render::RawSensor>& sensor, const RenderJobOptions& options) {
    if (!sensor) {
        return render::PixelFilter::named(options.filter);
    }
    if (options.filter != "box") {
        throw InputError(
            fmt::format("--filter is \"{}\", but {} has a table [sensor], which says what a pixel sees: "
                        "expected no filter",
                        options.filter, options.scene));
    }
    return render::pixel_aperture(*sensor);
}

/// What is wrong with the scene names its place in the file; what the camera's lens refuses is said of the camera.
template <class Make>
auto said_of_scene(const RenderJobOptions& options, const Make& make) {
    try {
        return make();
    } catch (const InputError& error) {
        const std::string message = error.what();
        throw InputError(message.starts_with(options.scene) ? message
                                                            : fmt::format("{}: camera: {}", options.scene, message));
    }
}

std::string settings_of(const RenderJobOptions& options, const render::PixelFilter& filter) {
    return fmt::format("{} filter, {} features", filter.name(), options.has_features ? "with" : "no");
}

int render_chart_scene(const RenderJobOptions& options) {
    const render::ChartScene scene = render::read_chart_scene(options.scene);
    if (scene.sensor) {
        raw_files(render_files(options).exr);
    }
    const render::PixelFilter filter = filter_of(scene.sensor, options);
    const auto prepared = said_of_scene(options, [&] {
        return std::make_unique<render::ChartCamera>(scene.camera, scene.light, scene.spectral, Cache::standard(),
                                                     filter);
    });
    const render::ChartCamera& camera = *prepared;
    if (!camera.spectral().clamp_note.empty()) {
        fmt::print(stderr, "lensproof: {}\n", camera.spectral().clamp_note);
    }
    render::SeenChart view = camera.view(scene.chart, scene.placement);
    view.has_features = options.has_features;
    const render::ChartRender render(std::move(view), camera.pupil(), options.common.seed);
    RenderJob job;
    job.film = render.film();
    job.make_renderer = [&render] { return render.make_renderer(); };
    job.identity = {{"scene", hash_text(read_file(options.scene))},
                    {"lens", camera.lens_hash()},
                    {"settings", settings_of(options, filter)}};
    job.notes.metadata = camera.metadata();
    job.notes.colours = camera.colours();
    job.sensor = scene.sensor;
    job.samples = static_cast<std::uint32_t>(scene.samples_per_pixel);
    job.json["scene"] = options.scene;
    job.json["lens"] = camera.lens().id;
    return run_render_job(job, options);
}

/// Of the file and all files that it names.
std::string scene_hash(const render::SceneSetup& setup, const std::string& file) {
    std::string hashes = hash_text(read_file(file));
    for (const std::filesystem::path& named : scene::named_files(setup.scene)) {
        hashes += hash_text(read_file(named));
    }
    return hash_text(hashes);
}

/// Where paths begin.
enum class PathsFrom { camera, light, both };

PathsFrom paths_from(const std::string& name) {
    return name == "camera" ? PathsFrom::camera : name == "light" ? PathsFrom::light : PathsFrom::both;
}

/// What of it stands among a render's settings.
std::string kept_apart(PathsFrom from) {
    return from == PathsFrom::camera ? "" : from == PathsFrom::light ? ", light paths" : ", camera and light paths";
}

render::TileRenderer renderer_of(const render::SceneView& view, const render::CameraEnd* end, PathsFrom from) {
    if (from == PathsFrom::camera) {
        return render::scene_renderer(view);
    }
    return from == PathsFrom::light ? render::light_path_renderer(view, *end) : render::both_paths_renderer(view, *end);
}

int render_scene(const RenderJobOptions& options, PathsFrom from) {
    const render::SceneSetup setup = render::read_scene_setup(options.scene);
    if (setup.sensor) {
        raw_files(render_files(options).exr);
    }
    const render::PixelFilter filter = filter_of(setup.sensor, options);
    const auto scene = said_of_scene(
        options, [&] { return std::make_unique<render::PreparedScene>(setup, filter, Cache::standard()); });
    for (const std::string& remark : scene->remarks()) {
        fmt::print(stderr, "lensproof: {}\n", remark);
    }
    render::SceneView view = scene->view(options.common.seed, options.has_features);
    view.film.has_splats = from != PathsFrom::camera;
    RenderJob job;
    job.film = view.film;
    const render::CameraEnd* end = from != PathsFrom::camera ? &scene->camera_end(Cache::standard()) : nullptr;
    job.make_renderer = [&view, end, from] { return renderer_of(view, end, from); };
    job.identity = {{"scene", scene_hash(setup, options.scene)},
                    {"lens", scene->camera_hash()},
                    {"settings", settings_of(options, filter) + kept_apart(from)}};
    job.notes.metadata = scene->metadata();
    job.notes.colours = scene->colours();
    job.sensor = setup.sensor;
    job.samples = static_cast<std::uint32_t>(setup.samples_per_pixel);
    job.json["scene"] = options.scene;
    job.json["lens"] = scene->lens_id();
    return run_render_job(job, options);
}

int run_render(const RenderJobOptions& options, PathsFrom from) {
    render_files(options);  // before long work
    const bool is_chart = TomlTable::read(options.scene).has("chart");
    if (from != PathsFrom::camera && is_chart) {
        throw InputError("--paths light and both are for scenes with lights, not for a [chart] in an even world");
    }
    if (from == PathsFrom::light && (options.noise > 0.0 || options.has_features)) {
        throw InputError("--paths light goes neither with --noise nor with --features; --paths both does");
    }
    return is_chart ? render_chart_scene(options) : render_scene(options, from);
}

}  // namespace

void add_render_command(Program& program) {
    const auto options = std::make_shared<RenderJobOptions>();
    Command command = program.add_command("render", "Render a scene or a chart through a lens");
    command.footer(
        "Example: lensproof render experiments/scenes/tessar_checkerboard.toml -o chart.exr\n"
        "         lensproof render experiments/scenes/cornell_box.toml --spp 256 -o box.exr\n"
        "         lensproof render SCENE --noise 0.01 --time 3600 --preview now.png --checkpoint chart.checkpoint\n"
        "         lensproof render SCENE --spp 1024 --shard 2/5 -o part2.exr; lensproof merge part*.exr -o chart.exr\n"
        "Ctrl-C ends a render with a checkpoint written and exit status 3; a second one at once.");
    command.add_option("SCENE", options->scene, "A scene file").required();
    add_render_job_options(command, *options);
    const auto paths = std::make_shared<std::string>("camera");
    command
        .add_option("--paths", *paths,
                    "Where paths begin: camera (the default); light, which finds what shines through glass and cannot "
                    "see mirrors; or both, each counted by how well it makes what it finds. One image by each")
        .check(one_of({"camera", "light", "both"}));
    command.runs([options, paths] { return run_render(*options, paths_from(*paths)); });
}

}  // namespace lensproof::cli
