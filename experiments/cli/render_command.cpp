// experiments/cli/render_command.cpp — `lensproof render SCENE`: a chart through a lens.
#include <fmt/format.h>

#include <memory>

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

int run_render(const RenderOptions& options) {
    const ChartScene scene = read_chart_scene(options.scene);
    const ChartCamera camera(scene.camera, scene.light, scene.spectral);
    if (!camera.spectral().clamp_note.empty()) {
        fmt::print(stderr, "lensproof: {}\n", camera.spectral().clamp_note);
    }
    const RenderSettings settings{.samples_per_pixel = options.samples > 0 ? options.samples : scene.samples_per_pixel,
                                  .seed = options.common.seed,
                                  .threads = options.common.threads};
    ProgressBar bar("rendering", options.common.quiet);
    const Image image = camera.render(scene.chart, scene.placement, settings, [&](double done) { bar.update(done); });

    std::filesystem::path exr = options.output.empty()
                                    ? std::filesystem::path(options.scene).filename().replace_extension(".exr")
                                    : std::filesystem::path(options.output);
    const std::filesystem::path png = std::filesystem::path(exr).replace_extension(".png");
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
