// experiments/cli/render_command.cpp — `lensproof render SCENE`: a scene, or a chart, through a lens.
#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <memory>
#include <optional>
#include <utility>

#include "engine/base/cache.h"
#include "engine/base/file.h"
#include "engine/base/hash.h"
#include "engine/base/input_error.h"
#include "engine/render/metering.h"
#include "engine/render/prepared_scene.h"
#include "engine/scene/scene_build.h"
#include "experiments/cli/device_option.h"
#include "experiments/cli/planned_render.h"
#include "experiments/cli/raw_files.h"
#include "experiments/cli/render_job.h"
#include "experiments/cli/terminal.h"
#include "experiments/studies/tradeoff/spot_check.h"

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

/// What is wrong with the scene names its place in the file; what is wrong with the camera or a file that it names is
/// said of the scene.
template <class Make>
auto said_of_scene(const RenderJobOptions& options, const Make& make) {
    try {
        return make();
    } catch (const InputError& error) {
        const std::string message = error.what();
        throw InputError(message.starts_with(options.scene) ? message : fmt::format("{}: {}", options.scene, message));
    }
}

/// The scene with another model of its lens.
void take_model(const std::string& name, const std::string& file, render::SceneSetup& setup) {
    setup.camera.model = render::lens_model_named(name).value();
    if (const auto conflict = render::model_conflict(setup.camera)) {
        throw InputError(fmt::format("--model is \"{}\", but in {} the camera's {} {}", name, file, conflict->key,
                                     conflict->message));
    }
}

/// Of the file and, where it is not a chart's, all files that it names.
std::string scene_hash(const render::SceneSetup& setup, const std::string& file) {
    std::string hashes = hash_text(read_file(file));
    if (setup.chart) {
        return hashes;
    }
    for (const std::filesystem::path& named : scene::named_files(setup.scene)) {
        hashes += hash_text(read_file(named));
    }
    return hash_text(hashes);
}

std::vector<std::string> pass_names() {
    std::vector<std::string> names;
    std::ranges::transform(render::passes(), std::back_inserter(names), &render::Pass::name);
    return names;
}

std::string pass_list() {
    std::vector<std::string> entries;
    for (const render::Pass& pass : render::passes()) {
        entries.push_back(fmt::format("{} ({})", pass.name, pass.description));
    }
    return fmt::format("{}", fmt::join(entries, "; "));
}

/// Throws InputError where these passes do not add up to a picture.
void check_passes(const std::vector<std::string>& passes, const RenderJobOptions& options) {
    if (const std::string conflict = render::pass_conflict(passes); !conflict.empty()) {
        throw InputError("--passes " + conflict);
    }
    const auto has = [&](const char* name) { return std::ranges::find(passes, name) != passes.end(); };
    if (!passes.empty() && options.has_features && !has("imaged") && !has("straight")) {
        throw InputError("--features goes with the pass imaged or straight, expected one of them in --passes");
    }
}

/// Says where the light goes that comes into the camera.
Json audit_json(const render::PreparedScene& scene, const RenderJobOptions& options) {
    constexpr std::uint32_t kPaths = 1U << 19U;  // of a half, 0.07 %
    const render::EnergyAudit audit = said_of_scene(options, [&] { return scene.audit(options.common.seed, kPaths); });
    Json json = {{"light_in_w_per_nm", audit.light_in}};
    for (std::size_t i = 0; i < audit.fractions.size(); ++i) {
        const auto& [fraction, error] = audit.fractions[i];
        const std::string& name = render::fate_names()[i];
        json[name + "_percent"] = 100.0 * fraction;
        json[name + "_standard_error_percent"] = 100.0 * error;
        if (prints_text(options.common)) {
            print("light that comes in, {:<8} {:8.3f} ± {:.3f} %\n", name, 100.0 * fraction, 100.0 * error);
        }
    }
    return json;
}

struct RenderWishes {
    std::string model;      // empty: the scene's; "auto": as a plan has it
    std::string tolerance;  // of the plan
    std::string precision;  // of hits; empty: the scene's
    std::string paths = "camera";
    std::vector<std::string> passes;
    bool is_audited = false;
    std::string device = "cpu";
};

/// Takes a plan's model, bounces and wavelengths for the scene, and its passes for what is wished. Throws InputError
/// where both say what to render.
studies::Plan take_plan(const RenderJobOptions& options, RenderWishes& wishes, render::SceneSetup& setup) {
    if (!wishes.passes.empty()) {
        throw InputError("--model auto decides which passes are rendered, expected no --passes beside it");
    }
    if (options.samples > 0) {
        setup.samples_per_pixel = static_cast<int>(options.samples);
    }
    const studies::Plan pilot = plan_of(setup, options.scene, wishes.tolerance, options.common);
    studies::SpotCheckSettings check = studies::SpotCheckSettings::for_render(setup);
    check.seed = options.common.seed;
    check.threads = options.common.threads;
    check.cache = Cache::standard();
    studies::Plan plan = studies::spot_checked(pilot, setup, check);
    setup = studies::planned_setup(std::move(setup), plan.render);
    if (!plan.render.passes.empty()) {
        wishes.passes = {"straight"};
        wishes.passes.insert(wishes.passes.end(), plan.render.passes.begin(), plan.render.passes.end());
    }
    print_message("lensproof: planned: {}\n", plan_text(pilot));
    for (std::size_t i = pilot.refused.size(); i < plan.refused.size(); ++i) {
        print_message("lensproof: revised: {}; {} takes its place\n", plan.refused[i],
                      i + 1 < plan.refused.size() ? "the next" : plan.render.rung.name);
    }
    return plan;
}

int run_render(const RenderJobOptions& options, RenderWishes wishes) {
    const RenderFiles files = render_files(options);  // before long work
    const std::shared_ptr<device::SharedDevice> device = shared_device(wishes.device, OnRefusal::end);
    check_passes(wishes.passes, options);
    if ((wishes.model == "auto") == wishes.tolerance.empty()) {
        throw InputError("--model auto and --tolerance go together, expected both or neither");
    }
    render::SceneSetup setup = render::read_scene_setup(options.scene);
    const bool is_metered =
        said_of_scene(options, [&] { return render::meter(setup, Cache::standard(), options.common.threads); });
    std::optional<studies::Plan> plan;
    if (wishes.model == "auto") {
        plan = take_plan(options, wishes, setup);
    } else if (!wishes.model.empty()) {
        take_model(wishes.model, options.scene, setup);
    }
    const std::string& paths = wishes.paths;
    const std::vector<std::string>& passes = wishes.passes;
    if (paths != "camera" && setup.chart) {
        throw InputError("--paths light and both are for scenes with lights, not for a [chart] in an even world");
    }
    if (!passes.empty() && setup.chart) {
        throw InputError("--passes is for scenes with lights, not for a [chart] in an even world");
    }
    if (wishes.is_audited && setup.chart) {
        throw InputError("--audit is for scenes with lights, not for a [chart] in an even world");
    }
    if (!wishes.precision.empty()) {
        if (setup.chart) {
            throw InputError("--precision is for scenes with lights, not for a [chart] in an even world");
        }
        setup.scene.precision = scene::hit_precision_named(wishes.precision);
    }
    if (paths == "light" && (options.noise > 0.0 || options.has_features)) {
        throw InputError("--paths light goes neither with --noise nor with --features; --paths both does");
    }
    if (setup.sensor) {
        raw_files(files.exr);
    }
    const render::PixelFilter filter = filter_of(setup.sensor, options);
    const auto scene = said_of_scene(options, [&] {
        return std::make_unique<render::PreparedScene>(
            setup, filter, Cache::standard(), render::PassIntegrators{.usual = &render::integrator_named(paths)},
            std::nullopt, device);
    });
    for (const std::string& remark : scene->remarks()) {
        print_message("lensproof: {}\n", remark);
    }
    const std::optional<optics::Lens>& lens = scene->camera().lens();
    if (lens) {
        print_findings(options.common, *lens);
    }
    RenderJob job{.passes = passes, .renders = {}};
    if (passes.empty()) {
        job.passes.emplace_back();
        job.renders.push_back(scene->render(options.common.seed, options.has_features));
    }
    if (!passes.empty()) {
        job.renders =
            said_of_scene(options, [&] { return scene->render(passes, options.common.seed, options.has_features); });
    }
    job.identity = {
        {"scene", scene_hash(setup, options.scene)},
        {"lens", scene->camera_hash()},
        {"settings", fmt::format("{} filter, {} features{}", filter.name(), options.has_features ? "with" : "no",
                                 scene->integrator().description) +
                         (passes.empty() ? "" : fmt::format(", passes {}", fmt::join(passes, " and "))) +
                         (plan ? fmt::format(", at most {} scatterings", setup.max_bounces) : "") +
                         (setup.scene.precision == scene::HitPrecision::in_float ? ", hits in float" : "")}};
    job.notes.metadata = scene->metadata();
    job.notes.colours = scene->camera().colours();
    if (is_metered) {
        job.notes.metadata["lensproof:exposure"] = "automatic";
        const auto& [time_s, iso] = setup.camera.exposure;
        job.json["exposure"] = {{"automatic", true}, {"shutter_s", time_s}, {"iso", iso}};
        print_message("lensproof: exposed automatically: {:.3g} s at ISO {:g}\n", time_s, iso);
    }
    job.samples = static_cast<std::uint32_t>(setup.samples_per_pixel);
    job.smooth = plan ? plan->render.smooth : std::vector<render::SmoothPass>();
    job.sensor = setup.sensor;
    job.json["scene"] = options.scene;
    job.json["lens"] = lens ? lens->id : "";
    job.json["model"] = render::name_of(setup.camera.model);
    job.json["precision"] = scene::name_of(setup.scene.precision);
    if (plan) {
        job.json["plan"] = studies::plan_json(*plan);
        job.notes.metadata["lensproof:plan"] = studies::plan_json(*plan, studies::PlanTimes::left_out).dump();
    }
    job.json["findings"] = findings_json(lens ? lens->findings : std::vector<optics::Finding>());
    if (wishes.is_audited) {
        job.json["energy"] = audit_json(*scene, options);
    }
    return run_render_job(job, options);
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
        "         lensproof render SCENE --passes imaged,direct,ghosts -o flare.exr\n"
        "The JSON says under \"run\" how long it took, how fast it was and why it ended: samples, noise, time or "
        "interrupted.\n"
        "Ctrl-C ends a render with a checkpoint written and exit status 3; a second one at once.");
    command.add_option("SCENE", options->scene, "A scene file").required();
    add_render_job_options(command, *options);
    const auto wishes = std::make_shared<RenderWishes>();
    std::vector<std::string> models = render::lens_model_names();
    models.emplace_back("auto");
    command
        .add_option("--model", wishes->model,
                    fmt::format("What stands for the lens, in place of the scene's model: {}; auto: what --tolerance "
                                "needs, as `plan` says",
                                fmt::join(render::lens_model_names(), ", ")))
        .check(one_of(models));
    command
        .add_option("--tolerance", wishes->tolerance,
                    "What may be wrong, for --model auto: such as 0.5px,0.02ev,1de, or visible")
        .type_name("T");
    command
        .add_option("--precision", wishes->precision,
                    "Who says which triangle of a larger mesh a ray meets first, in place of the scene's precision: "
                    "double; or float, which is faster and takes surfaces a few µm apart for one")
        .check(one_of(scene::hit_precision_names()));
    command
        .add_option("--paths", wishes->paths,
                    "Where paths begin: camera (the default); light, which finds what shines through glass and cannot "
                    "see mirrors; or both, each counted by how well it makes what it finds. One image by each")
        .check(one_of({"camera", "light", "both"}));
    command
        .add_option("--passes", wishes->passes,
                    "Classes of light paths, each a film of its own, whose sum is the picture (default: imaged and "
                    "direct in one film): " +
                        pass_list())
        .check(one_of(pass_names()))
        .separated_by(',')
        .takes_one_argument();
    command.add_flag("--audit", wishes->is_audited,
                     "Also say where the light goes that comes into the lens: imaged, ghosts, barrel, beside the film, "
                     "out of the front, clipped, absorbed");
    add_device_option(command, wishes->device);
    command.runs([options, wishes] { return run_render(*options, *wishes); });
}

}  // namespace lensproof::cli
