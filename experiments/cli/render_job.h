// experiments/cli/render_job.h — how `lensproof render` carries a render out, whatever is rendered: until when, in
// which part, with which preview, checkpoint and files.
#pragma once
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/json.h"
#include "engine/render/film/film_exr.h"
#include "engine/render/film/smoothed_film.h"
#include "engine/render/progressive.h"
#include "engine/render/raw/raw_sensor.h"
#include "experiments/cli/command.h"
#include "experiments/cli/shard.h"

namespace lensproof::cli {

struct RenderJobOptions {
    CommonOptions common;
    std::string scene;
    std::string output;
    std::string half;           // a file; empty: none
    std::uint32_t samples = 0;  // 0: the scene's; with --time or --noise as many as it takes
    double time_s = 0.0;        // 0: no limit
    double noise = 0.0;         // 0: none wanted
    std::string preview;
    std::string checkpoint;
    double checkpoint_interval_s = 60.0;
    std::string shard;
    std::string filter = "box";
    bool has_features = false;
    bool has_digest = false;  // shards always have one
    bool is_denoised = false;
};

/// Adds the options above, but those that name the scene.
void add_render_job_options(Command& command, RenderJobOptions& options);

/// The files that a job writes. Throws InputError where one cannot be, or where the options make no sense by
/// themselves: to be asked before long work begins.
struct RenderFiles {
    std::filesystem::path exr;
    std::filesystem::path png;
    std::filesystem::path half;  // empty: none is asked for
};
RenderFiles render_files(const RenderJobOptions& options);

/// What is rendered.
struct RenderJob {
    std::vector<std::string> passes;          // their names; one alone may have none
    std::vector<render::Render> renders;      // as many
    render::RenderIdentity identity;          // "scene", "lens", "settings"; seed and version are added
    render::FilmNotes notes;                  // metadata and colours
    std::uint32_t samples = 0;                // a pixel, the scene's own
    std::vector<render::SmoothPass> smooth;   // those of the passes whose light is
    std::optional<render::RawSensor> sensor;  // for a raw file beside the film's, of a whole render
    Json json;                                // what the machine-readable result begins with
};

/// Says on standard error, and in `json`, how many samples were left out of the film, where any were.
void report_left_out(const render::Picture& film, Json& json);

/// Renders, writes the pictures and says where they are. Returns the exit status: kInternalFailure where a signal ended
/// it before its goal, with a checkpoint written and the picture so far beside it.
int run_render_job(const RenderJob& job, const RenderJobOptions& options);

}  // namespace lensproof::cli
