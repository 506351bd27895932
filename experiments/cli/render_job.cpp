#include "experiments/cli/render_job.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <set>

#include "engine/base/file.h"
#include "engine/base/input_error.h"
#include "engine/base/json.h"
#include "engine/base/write_file.h"
#include "engine/render/checkpoint.h"
#include "engine/render/engine_version.h"
#include "engine/render/film/film_image.h"
#include "engine/render/pass_turns.h"
#include "experiments/cli/denoised_files.h"
#include "experiments/cli/interruption.h"
#include "experiments/cli/progress.h"
#include "experiments/cli/raw_files.h"
#include "experiments/cli/terminal.h"

namespace lensproof::cli {

namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;
using States = std::span<const render::RenderState>;  // of the passes

/// Samples a pixel of the whole render, of which a shard has a part: as many as asked for; else the scene's, or without
/// end where something else ends it.
std::uint32_t whole_samples(const RenderJob& job, const RenderJobOptions& options) {
    if (options.samples > 0) {
        return options.samples;
    }
    return options.time_s > 0.0 || options.noise > 0.0 ? render::kMostSamples : job.samples;
}

render::SampleRange range_of(const RenderJob& job, const RenderJobOptions& options) {
    const Shard shard = read_shard(options.shard);
    const std::uint32_t samples = whole_samples(job, options);
    if (const std::uint32_t most = most_shards(samples); static_cast<std::uint32_t>(shard.count) > most) {
        throw InputError(
            fmt::format("--shard is \"{}\": {} samples a pixel are dealt in blocks of {}, expected i/n with n ≤ {}",
                        options.shard, samples, render::kSamplesPerBlock, most));
    }
    return shard.part_of(samples);
}

/// Nothing where the pass's light is not known to be smooth.
const render::SmoothPass* smoothness_of(const RenderJob& job, const std::string& pass) {
    const auto found = std::ranges::find(job.smooth, pass, &render::SmoothPass::pass);
    return found == job.smooth.end() ? nullptr : &*found;
}

render::RenderGoal goal_of(const RenderJobOptions& options) {
    render::RenderGoal goal;
    if (options.time_s > 0.0) {
        goal.seconds = options.time_s;
    }
    // n shards of relative error e each have e/√n together.
    goal.noise = options.noise * std::sqrt(static_cast<double>(read_shard(options.shard).count));
    return goal;
}

/// What is done from time to time while a render runs: the bar, the preview, the checkpoint.
class RenderWatch {
  public:
    RenderWatch(const RenderJobOptions& options, const render::RenderIdentity& identity)
        : options_(options), identity_(identity), bar_("rendering", options.common.quiet) {}

    void look(States passes, const render::RenderReport& report) {
        latest_ = report;
        bar_.update(report.done, report.seconds_left, speed(report));
        // Drawing takes a twentieth of the time at most.
        if (!options_.preview.empty() && seconds_since(preview_) > std::max(1.0, 20.0 * preview_cost_s_)) {
            const Clock::time_point start = Clock::now();
            write_preview(passes);
            preview_cost_s_ = seconds_since(start);
            preview_ = Clock::now();
        }
        if (!options_.checkpoint.empty() && seconds_since(checkpoint_) > options_.checkpoint_interval_s) {
            write_checkpoint(passes);
            checkpoint_ = Clock::now();
        }
    }

    /// Where there is nothing more to render: both as they are now.
    void look_last(States passes) {
        if (!options_.checkpoint.empty()) {
            write_checkpoint(passes);
        }
        if (!options_.preview.empty()) {
            write_preview(passes);
        }
    }

    /// Of this run; nothing where nothing was left to render.
    [[nodiscard]] const render::RenderReport& latest() const { return latest_; }

  private:
    void write_preview(States passes) {
        attempt(options_.preview,
                [&] { formats::write_png(render::film_rgb(render::picture_of(passes)), options_.preview); });
    }

    void write_checkpoint(States passes) {
        attempt(options_.checkpoint, [&] { render::write_checkpoint(options_.checkpoint, identity_, passes); });
    }

    /// A disk that is full for a while is no reason to lose a render: it is said once, and tried again the next time.
    void attempt(const std::string& file, const std::function<void()>& write) {
        try {
            write();
            failing_.erase(file);
        } catch (const std::exception& failure) {
            if (failing_.insert(file).second) {
                print_message("lensproof: {}; the render goes on without\n", failure.what());
            }
        }
    }

    static std::string speed(const render::RenderReport& report) {
        const bool has_rays = report.rays > 0;
        const auto count = static_cast<double>(has_rays ? report.rays : report.samples);
        return fmt::format("{:.2f} M {}/s", 1e-6 * count / std::max(1e-9, report.seconds),
                           has_rays ? "rays" : "samples");
    }

    const RenderJobOptions& options_;
    const render::RenderIdentity& identity_;
    ProgressBar bar_;
    render::RenderReport latest_;
    Clock::time_point preview_ = Clock::now() - std::chrono::hours(1);  // the first at once
    double preview_cost_s_ = 0.0;
    Clock::time_point checkpoint_ = Clock::now();
    std::set<std::string> failing_;
};

/// Wall clock and processors' time since it was made.
class Stopwatch {
  public:
    [[nodiscard]] double wall_s() const { return seconds_since(begin_); }
    [[nodiscard]] double cpu_s() const { return static_cast<double>(std::clock() - cpu_begin_) / CLOCKS_PER_SEC; }

  private:
    Clock::time_point begin_ = Clock::now();
    std::clock_t cpu_begin_ = std::clock();
};

/// Why a render has no more samples.
std::string end_name(render::RenderEnd end, States passes, const RenderJobOptions& options) {
    if (end != render::RenderEnd::complete) {
        return end == render::RenderEnd::interrupted ? "interrupted" : "time";
    }
    if (!(options.noise > 0.0)) {
        return "samples";
    }
    const render::Picture picture = render::picture_of(passes);
    const std::vector<render::PixelRect> tiles = render::film_tiles(picture.width(), picture.height());
    const double dark = render::kDarkFraction * render::mean_brightness(picture);
    const double noise = goal_of(options).noise;
    for (std::size_t i = 0; i < tiles.size(); ++i) {
        const bool has_all = std::ranges::all_of(
            passes, [&](const render::RenderState& state) { return state.tiles[i].done == state.range.end; });
        if (has_all && render::tile_error(picture, tiles[i], dark) > noise) {
            return "samples";  // before it was good enough
        }
    }
    return "noise";
}

/// How long this run took, how fast it was, and why it ended.
Json run_json(const Stopwatch& stopwatch, const render::RenderReport& latest, const std::string& end) {
    const double wall_s = stopwatch.wall_s();
    Json json{{"ended_by", end},
              {"wall_seconds", wall_s},
              {"cpu_seconds", stopwatch.cpu_s()},
              {"samples", latest.samples},
              {"samples_per_second", wall_s > 0.0 ? static_cast<double>(latest.samples) / wall_s : 0.0}};
    if (latest.rays > 0) {
        json["rays"] = latest.rays;
        json["rays_per_second"] = wall_s > 0.0 ? static_cast<double>(latest.rays) / wall_s : 0.0;
    }
    return json;
}

/// Samples a pixel, the mean over a film.
double mean_samples(const render::RenderState& state) {
    double sum = 0.0;
    for (int y = 0; y < state.film.height(); ++y) {
        for (int x = 0; x < state.film.width(); ++x) {
            sum += state.film.counts(x, y).samples;
        }
    }
    return sum / (static_cast<double>(state.film.width()) * state.film.height());
}

/// What a film has of light: the mean of R, G and B over its pixels.
double light_of(const render::Film& film) {
    double sum = 0.0;
    for (int y = 0; y < film.height(); ++y) {
        for (int x = 0; x < film.width(); ++x) {
            const Vec3d rgb = film.estimate(x, y).rgb;
            sum += (rgb.x + rgb.y + rgb.z) / 3.0;
        }
    }
    return sum / (static_cast<double>(film.width()) * film.height());
}

/// `file`, and the same name wherever else a file was asked for.
std::vector<fs::path> places_for(const fs::path& file, const RenderJobOptions& options, const RenderFiles& files) {
    std::vector<fs::path> places = {file};
    for (const fs::path& other : {files.exr, fs::path(options.checkpoint), fs::path(options.preview),
                                  fs::path(options.common.json_file == "-" ? "" : options.common.json_file)}) {
        if (const fs::path place = other.parent_path() / file.filename(); !other.empty() && place != places.front()) {
            places.push_back(place);
        }
    }
    return places;
}

render::FilmNotes notes_of(const RenderJob& job, const RenderJobOptions& options,
                           const render::RenderIdentity& identity) {
    render::FilmNotes notes = job.notes;
    notes.identity = identity;
    if (job.sensor) {
        notes.metadata[kSensorNote] = render::raw_sensor_text(*job.sensor);
    }
    notes.metadata["lensproof:samplesPerPixel"] = fmt::format("{}", whole_samples(job, options));
    if (options.time_s > 0.0) {
        notes.metadata["lensproof:time_s"] = fmt::format("{}", options.time_s);
    }
    if (options.noise > 0.0) {
        notes.metadata["lensproof:noise"] = fmt::format("{}", options.noise);
    }
    notes.has_digest = options.has_digest || !options.shard.empty();
    if (!options.shard.empty()) {
        const Shard shard = read_shard(options.shard);
        notes.metadata[kShardNote] = shard_set_text({.indices = {shard.index}, .count = shard.count});
    }
    return notes;
}

/// The picture as far as it is, beside the checkpoint. That it cannot be written is said.
Json write_so_far(States passes, render::FilmNotes notes, const fs::path& checkpoint) {
    notes.metadata["lensproof:interruptedAfter"] = fmt::format("{:.1f} samples a pixel", mean_samples(passes.front()));
    const render::Picture picture = render::picture_of(passes);
    const std::string exr = checkpoint.string() + ".exr";
    const std::string png = checkpoint.string() + ".png";
    try {
        render::write_film_exr(picture, notes, exr);
        formats::write_png(render::film_rgb(picture), png);
    } catch (const std::exception& failure) {
        print_message("lensproof: {}; there is no picture of what was rendered\n", failure.what());
        return {};
    }
    print_message("lensproof: the picture so far is {}\n", exr);
    return {{"exr", exr}, {"png", png}};
}

/// Where an interrupted render is kept.
std::string checkpoint_name(const RenderJobOptions& options, const RenderFiles& files) {
    return options.checkpoint.empty() ? files.exr.string() + ".checkpoint" : options.checkpoint;
}

/// Saves what there is, and says how to go on.
int end_early(Json json, States passes, const render::FilmNotes& notes, const RenderJobOptions& options,
              const RenderFiles& files) {
    const std::string checkpoint = checkpoint_name(options, files);
    const Delivery delivery = write_somewhere(places_for(checkpoint, options, files), [&](const fs::path& place) {
        render::write_checkpoint(place, notes.identity, passes);
    });
    if (!delivery.complaint.empty()) {
        print_message("lensproof: {}\n", delivery.complaint);
    }
    print_message(
        "lensproof: interrupted after {:.1f} samples a pixel of {}; the same command with --checkpoint {} goes "
        "on from there\n",
        mean_samples(passes.front()), passes.front().range.end - passes.front().range.first, delivery.place.string());
    json["samples_per_pixel"] = mean_samples(passes.front());
    json["seed"] = options.common.seed;
    json["checkpoint"] = delivery.place.string();
    if (options.shard.empty()) {  // nobody looks at a shard's, and whoever ends one has little time
        json["so_far"] = write_so_far(passes, notes, delivery.place);
    }
    write_json_result(options.common, json);
    return kInternalFailure;
}

/// The picture alone, in half floats, where it is asked for; what they cannot hold is said.
std::optional<Delivery> write_half(const render::Picture& picture, const render::FilmNotes& notes,
                                   const RenderJobOptions& options, const RenderFiles& files, Json& json) {
    if (files.half.empty()) {
        return {};
    }
    std::size_t clipped = 0;
    Delivery delivery = write_somewhere(places_for(files.half, options, files), [&](const fs::path& place) {
        clipped = render::write_half_exr(picture, notes, place);
    });
    if (clipped > 0) {
        print_message("lensproof: {} numbers are larger than a half float's 65504, {} has that in their place\n",
                      clipped, delivery.place.string());
        json["half_clipped"] = clipped;
    }
    return delivery;
}

void report(Json json, States passes, const RenderJobOptions& options, const RenderFiles& files,
            const std::optional<RawFiles>& raw) {
    const render::Picture picture = render::picture_of(passes);
    json["samples_per_pixel"] = mean_samples(passes.front());
    if (passes.size() > 1) {
        for (const render::RenderState& state : passes) {
            json["passes"].push_back(
                {{"pass", state.pass}, {"samples_per_pixel", mean_samples(state)}, {"light", light_of(state.film)}});
        }
    }
    json["seed"] = options.common.seed;
    if (!options.shard.empty()) {
        json["shard"] = options.shard;
    }
    const render::PixelRect all{.x = 0, .y = 0, .width = picture.width(), .height = picture.height()};
    json["relative_error"] = render::tile_error(picture, all, 0.01 * render::mean_brightness(picture));
    report_left_out(picture, json);
    json["exr"] = files.exr.string();
    json["png"] = files.png.string();
    if (!files.half.empty()) {
        json["half"] = files.half.string();
    }
    if (prints_text(options.common)) {
        print("{}\n{}\n", files.exr.string(), files.png.string());
        if (!files.half.empty()) {
            print("{}\n", files.half.string());
        }
    }
    if (raw) {
        report_raw_files(*raw, json, options.common);
    }
    write_json_result(options.common, json);
}

}  // namespace

RenderFiles render_files(const RenderJobOptions& options) {
    RenderFiles files{.exr = options.output, .png = {}, .half = options.half};
    const Shard shard = read_shard(options.shard);
    if (options.output.empty()) {
        files.exr = fs::path(options.scene)
                        .filename()
                        .replace_extension(options.shard.empty()
                                               ? ".exr"
                                               : fmt::format(".shard-{}-of-{}.exr", shard.index, shard.count));
    } else if (files.exr.has_filename() && files.exr.extension() != ".exr") {
        throw InputError(fmt::format("--output is \"{}\", expected a name that ends in .exr", options.output));
    }
    files.png = fs::path(files.exr).replace_extension(".png");
    if (!options.half.empty()) {
        if (files.half.extension() != ".exr" || files.half == files.exr) {
            throw InputError(fmt::format("--half is \"{}\", expected a name that ends in .exr, another than --output's",
                                         options.half));
        }
        check_output_name(files.half);
    }
    check_denoise(options.is_denoised);
    check_output_name(files.exr);
    check_output_name(files.png);
    check_json_name(options.common);
    if (!options.preview.empty()) {
        if (fs::path(options.preview).extension() != ".png") {
            throw InputError(fmt::format("--preview is \"{}\", expected a name that ends in .png", options.preview));
        }
        check_output_name(options.preview);
    }
    // If it is interrupted, these are written too.
    const std::string checkpoint = checkpoint_name(options, files);
    for (const std::string& name : {checkpoint, checkpoint + ".exr", checkpoint + ".png"}) {
        check_output_name(name);
    }
    return files;
}

int run_render_job(const RenderJob& job, const RenderJobOptions& options) {
    const RenderFiles files = render_files(options);
    render::RenderIdentity identity = job.identity;
    identity.push_back({"seed", fmt::format("{}", options.common.seed)});
    identity.push_back({"version", render::engine_version()});

    std::vector<render::RenderState> passes;
    for (std::size_t i = 0; i < job.renders.size(); ++i) {
        render::SampleRange range = range_of(job, options);
        // With --noise a film is judged as it is, before it is spread.
        if (const render::SmoothPass* smooth = smoothness_of(job, job.passes[i]); smooth && !(options.noise > 0.0)) {
            range.end = range.first + (range.end - range.first + smooth->fewer - 1) / smooth->fewer;
        }
        passes.emplace_back(job.renders[i].film, range, job.passes[i]);
    }
    if (!options.checkpoint.empty()) {
        if (is_there(options.checkpoint)) {
            render::read_checkpoint(options.checkpoint, identity, passes);
        }
    }
    const Interruption interruption;
    const Stopwatch stopwatch;
    render::RenderEnd end{};
    Json json = job.json;
    {
        RenderWatch watch(options, identity);
        const render::RenderControl control{
            .threads = options.common.threads,
            .in_rounds = job.renders.front().film.has_splats || !options.preview.empty() || options.time_s > 0.0,
            .is_interrupted = [] { return Interruption::has_come(); },
            .on_progress = [&](const render::RenderReport& report) { watch.look(passes, report); }};
        end = render::render_passes(passes, job.renders, goal_of(options), control);
        if (end != render::RenderEnd::interrupted) {
            watch.look_last(passes);
        }
        json["run"] = run_json(stopwatch, watch.latest(), end_name(end, passes, options));
    }
    const render::FilmNotes notes = notes_of(job, options, identity);
    if (end == render::RenderEnd::interrupted) {
        return end_early(std::move(json), passes, notes, options, files);
    }
    for (render::RenderState& state : passes) {
        if (const render::SmoothPass* smooth = smoothness_of(job, state.pass)) {
            state.film = render::smoothed(state.film, smooth->sigma_px, options.common.threads);
        }
    }
    const render::Picture picture = render::picture_of(passes);
    const Delivery exr = write_somewhere(places_for(files.exr, options, files),
                                         [&](const fs::path& place) { render::write_film_exr(picture, notes, place); });
    const Delivery png =
        write_somewhere({files.png, fs::path(exr.place).replace_extension(".png")},
                        [&](const fs::path& place) { formats::write_png(render::film_rgb(picture), place); });
    if (options.is_denoised) {
        write_denoised(picture, notes, exr.place, json, options.common);
    }
    const std::optional<Delivery> half = write_half(picture, notes, options, files, json);
    report(std::move(json), passes, options, {.exr = exr.place, .png = png.place, .half = half ? half->place : ""},
           write_raw_files(picture, notes, exr.place, options.common.threads));
    check_place(exr);
    check_place(png);
    if (half) {
        check_place(*half);
    }
    return kDone;
}

void report_left_out(const render::Picture& film, Json& json) {
    if (film.left_out() > 0) {
        print_message("lensproof: {} samples were no finite numbers; they were left out, as if they had met no light\n",
                      film.left_out());
        json["samples_left_out"] = film.left_out();
    }
}

void add_render_job_options(Command& command, RenderJobOptions& options) {
    const OptionCheck samples = in_range(1, static_cast<int>(render::kMostSamples));
    command.add_option("-o,--output", options.output, "EXR to write; a PNG appears beside it").type_name("FILE");
    command
        .add_option(
            "--half", options.half,
            "Also the picture alone as an EXR of one part, R, G and B in half floats: for programs that want no "
            "more")
        .type_name("FILE");
    command
        .add_option("--samples,--spp", options.samples,
                    "Samples a pixel, in place of the scene's; with --time or --noise, at most so many")
        .check(samples);
    command.add_option("--time", options.time_s, "End after so many seconds of rendering").check(kPositiveOption);
    command
        .add_option("--noise", options.noise,
                    "End where a pixel's standard error is this share of its value (0.01: 1 %), tile by tile")
        .check(kPositiveOption);
    command.add_option("--preview", options.preview, "A PNG that shows the picture as it grows").type_name("FILE");
    command
        .add_option("--checkpoint", options.checkpoint,
                    "Keep the render's state here; where the file is there, go on from it")
        .type_name("FILE");
    command.add_option("--checkpoint-interval", options.checkpoint_interval_s, "Seconds between two checkpoints")
        .check(kPositiveOption)
        .shows_default();
    command.add_option("--shard", options.shard, "Render the i-th of n parts of the samples; `merge` adds them up")
        .type_name("i/n");
    command.add_option("--filter", options.filter, "Pixel filter")
        .check(one_of(render::PixelFilter::known_names()))
        .shows_default();
    command.add_flag("--features", options.has_features, "Also write depth, albedo and normals");
    add_denoise_option(command, options.is_denoised);
    command.add_flag("--digest", options.has_digest,
                     "Also write a digest of all pixels, by which `merge` knows damage; shards always have one");
    add_common_options(command, options.common);
}

}  // namespace lensproof::cli
