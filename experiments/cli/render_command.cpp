// experiments/cli/render_command.cpp — `lensproof render SCENE`: a chart through a lens.
#include <fmt/format.h>

#include <memory>
#include <utility>

#include "engine/io/cache.h"
#include "engine/io/file.h"
#include "engine/io/hash.h"
#include "engine/io/input_error.h"
#include "engine/render/camera.h"
#include "experiments/cli/raw_files.h"
#include "experiments/cli/render_job.h"

namespace lensproof {

namespace {

/// What a pixel sees: the filter asked for, or what the scene's sensor says.
PixelFilter filter_of(const ChartScene& scene, const RenderJobOptions& options) {
    if (!scene.sensor) {
        return PixelFilter::named(options.filter);
    }
    if (options.filter != "box") {
        throw InputError(
            fmt::format("--filter is \"{}\", but {} has a table [sensor], which says what a pixel sees: "
                        "expected no filter",
                        options.filter, options.scene));
    }
    return pixel_aperture(*scene.sensor);
}

/// The scene's camera. What its lens refuses is said of the scene's file.
ChartCamera make_camera(const ChartScene& scene, const PixelFilter& filter, const RenderJobOptions& options) {
    try {
        return {scene.camera, scene.light, scene.spectral, Cache::standard(), filter};
    } catch (const InputError& error) {
        throw InputError(fmt::format("{}: camera: {}", options.scene, error.what()));
    }
}

int run_render(const RenderJobOptions& options) {
    const RenderFiles files = render_files(options);  // before long work
    const ChartScene scene = read_chart_scene(options.scene);
    if (scene.sensor) {
        raw_files(files.exr);
    }
    const PixelFilter filter = filter_of(scene, options);
    const ChartCamera camera = make_camera(scene, filter, options);
    if (!camera.spectral().clamp_note.empty()) {
        fmt::print(stderr, "lensproof: {}\n", camera.spectral().clamp_note);
    }
    SeenChart view = camera.view(scene.chart, scene.placement);
    view.has_features = options.has_features;
    const ChartRender render(std::move(view), camera.pupil(), options.common.seed);
    RenderJob job;
    job.film = render.film();
    job.make_renderer = [&render] { return render.make_renderer(); };
    job.identity = {
        {"scene", hash_text(read_file(options.scene))},
        {"lens", camera.lens_hash()},
        {"settings", fmt::format("{} filter, {} features", filter.name(), options.has_features ? "with" : "no")}};
    job.notes.metadata = camera.metadata();
    job.notes.colours = camera.colours();
    job.sensor = scene.sensor;
    job.samples = static_cast<std::uint32_t>(scene.samples_per_pixel);
    job.json["scene"] = options.scene;
    job.json["lens"] = camera.lens().id;
    return run_render_job(job, options);
}

}  // namespace

void add_render_command(CLI::App& app, int& status) {
    const auto options = std::make_shared<RenderJobOptions>();
    CLI::App* command = app.add_subcommand("render", "Render a chart through a lens");
    command->footer(
        "Examples: lensproof render experiments/scenes/tessar_checkerboard.toml -o chart.exr\n"
        "          lensproof render SCENE --noise 0.01 --time 3600 --preview now.png --checkpoint chart.checkpoint\n"
        "          lensproof render SCENE --spp 1024 --shard 2/5 -o part2.exr; lensproof merge part*.exr -o chart.exr\n"
        "Ctrl-C ends a render with a checkpoint written and exit status 3; a second one at once.");
    command->add_option("SCENE", options->scene, "A scene file")->required();
    add_render_job_options(*command, *options);
    command->callback([options, &status] { status = run_render(*options); });
}

}  // namespace lensproof
