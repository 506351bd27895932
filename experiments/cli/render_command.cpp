// experiments/cli/render_command.cpp — `lensproof render SCENE`: a chart through a lens.
#include <fmt/format.h>

#include <memory>

#include "engine/io/cache.h"
#include "engine/io/file.h"
#include "engine/io/input_error.h"
#include "engine/render/camera.h"
#include "experiments/cli/command.h"
#include "experiments/cli/progress.h"

namespace lensproof {

namespace {

struct RenderOptions {
    CommonOptions common;
    std::string scene;
    std::string output;
    int samples = 0;
};

/// The EXR's name; by default the scene's, in the current folder.
std::filesystem::path exr_name(const RenderOptions& options) {
    if (options.output.empty()) {
        return std::filesystem::path(options.scene).filename().replace_extension(".exr");
    }
    std::filesystem::path exr(options.output);
    if (exr.has_filename() && exr.extension() != ".exr") {
        throw InputError(fmt::format("--output is \"{}\", expected a name that ends in .exr", options.output));
    }
    return exr;
}

/// The scene's camera. What its lens refuses is said of the scene's file.
ChartCamera make_camera(const ChartScene& scene, const std::string& file) {
    try {
        return {scene.camera, scene.light, scene.spectral, Cache::standard()};
    } catch (const InputError& error) {
        throw InputError(fmt::format("{}: camera: {}", file, error.what()));
    }
}

int run_render(const RenderOptions& options) {
    const std::filesystem::path exr = exr_name(options);
    const std::filesystem::path png = std::filesystem::path(exr).replace_extension(".png");
    check_output_name(exr);
    check_output_name(png);
    check_json_name(options.common);
    const ChartScene scene = read_chart_scene(options.scene);
    const ChartCamera camera = make_camera(scene, options.scene);
    if (!camera.spectral().clamp_note.empty()) {
        fmt::print(stderr, "lensproof: {}\n", camera.spectral().clamp_note);
    }
    const RenderSettings settings{.samples_per_pixel = options.samples > 0 ? options.samples : scene.samples_per_pixel,
                                  .seed = options.common.seed,
                                  .threads = options.common.threads};
    ProgressBar bar("rendering", options.common.quiet);
    const Image image = camera.render(scene.chart, scene.placement, settings, [&](double done) { bar.update(done); });

    write_exr(image, exr);
    write_png(image, png);
    write_json_result(options.common, {{"scene", options.scene},
                                       {"lens", camera.lens().id},
                                       {"samples_per_pixel", settings.samples_per_pixel},
                                       {"seed", settings.seed},
                                       {"exr", exr.string()},
                                       {"png", png.string()}});
    if (prints_text(options.common)) {
        fmt::print("{}\n{}\n", exr.string(), png.string());
    }
    return kDone;
}

}  // namespace

void add_render_command(CLI::App& app, int& status) {
    const auto options = std::make_shared<RenderOptions>();
    CLI::App* command = app.add_subcommand("render", "Render a chart through a lens");
    command->footer("Example: lensproof render experiments/scenes/tessar_checkerboard.toml -o chart.exr");
    command->add_option("SCENE", options->scene, "A scene file")->required();
    command->add_option("-o,--output", options->output, "EXR to write; a PNG appears beside it")->type_name("FILE");
    command->add_option("--samples,--spp", options->samples, "Samples a pixel, in place of the scene's")
        ->check(CLI::Range(1, 1 << 20));
    add_common_options(*command, options->common);
    command->callback([options, &status] { status = run_render(*options); });
}

}  // namespace lensproof
