// experiments/cli/merge_command.cpp — `lensproof merge SHARD… -o FILE`: the whole of a render from its parts.
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>

#include "engine/base/input_error.h"
#include "engine/base/json.h"
#include "engine/base/write_file.h"
#include "engine/formats/image/image.h"
#include "engine/render/film/film_exr.h"
#include "engine/render/film/film_image.h"
#include "experiments/cli/command.h"
#include "experiments/cli/denoised_files.h"
#include "experiments/cli/raw_files.h"
#include "experiments/cli/render_job.h"
#include "experiments/cli/shard.h"
#include "experiments/cli/terminal.h"

namespace lensproof::cli {

namespace {

struct MergeOptions {
    CommonOptions common;
    std::vector<std::string> files;
    std::string output;
    bool takes_some = false;
    bool has_digest = false;  // what is a shard still always has one
    bool is_denoised = false;
};

/// A file and what its first look says.
struct Part {
    std::string file;
    render::FilmNotes notes;
    ShardSet shards;
};

Part look_at(const std::string& file) {
    render::FilmNotes notes = render::read_film_notes(file);
    const auto text = notes.metadata.find(kShardNote);
    if (text == notes.metadata.end()) {
        throw InputError(fmt::format("{}: is not a shard, expected a picture that `render --shard` made", file));
    }
    const std::optional<ShardSet> shards = parse_shard_set(text->second);
    if (!shards) {
        throw InputError(fmt::format("{}: says that it is shard \"{}\", expected i/n", file, text->second));
    }
    return {.file = file, .notes = std::move(notes), .shards = *shards};
}

/// Everything that has to be the same in shards of one render.
render::RenderIdentity common_to_shards(const Part& part) {
    render::RenderIdentity identity = part.notes.identity;
    for (const auto& [name, value] : part.notes.metadata) {
        if (name != kShardNote) {
            identity.push_back({name, value});
        }
    }
    return identity;
}

/// All shards in `parts`, checked: of one render, none twice.
ShardSet united(const std::vector<Part>& parts) {
    const Part& first = parts.front();
    ShardSet all{.indices = {}, .count = first.shards.count};
    std::map<int, std::string> holder;
    for (const Part& part : parts) {
        if (const auto difference = render::first_difference(common_to_shards(part), common_to_shards(first))) {
            throw InputError(fmt::format("{}: is of another render than {}: {}", part.file, first.file, *difference));
        }
        if (part.shards.count != all.count) {
            throw InputError(fmt::format("{}: is one of {} shards, {} is one of {}", part.file, part.shards.count,
                                         first.file, all.count));
        }
        for (const int index : part.shards.indices) {
            const auto [held, is_new] = holder.emplace(index, part.file);
            if (!is_new) {
                throw InputError(
                    fmt::format("{}: is shard {}/{}, which {} has too", part.file, index, all.count, held->second));
            }
        }
    }
    for (const auto& [index, file] : holder) {
        all.indices.push_back(index);
    }
    return all;
}

/// Adds the films up in the order of the shards, so that the order of the files makes no difference to any bit.
render::FilmFile sum_of(std::vector<Part> parts) {
    std::ranges::sort(parts, {}, [](const Part& part) { return part.shards.indices.front(); });
    render::FilmFile sum = render::read_film_exr(parts.front().file);
    for (std::size_t i = 1; i < parts.size(); ++i) {
        const render::FilmFile more = render::read_film_exr(parts[i].file);
        const auto can_merge = [](const render::PassFilm& a, const render::PassFilm& b) {
            return a.pass == b.pass && a.film.can_merge(b.film);
        };
        if (!std::ranges::equal(sum.films, more.films, can_merge)) {
            throw InputError(
                fmt::format("{}: has another size, other layers or passes than {}", parts[i].file, parts.front().file));
        }
        for (std::size_t pass = 0; pass < sum.films.size(); ++pass) {
            sum.films[pass].film.merge(more.films[pass].film);
        }
    }
    return sum;
}

int run_merge(const MergeOptions& options) {
    const std::filesystem::path exr(options.output);
    if (exr.has_filename() && exr.extension() != ".exr") {
        throw InputError(fmt::format("--output is \"{}\", expected a name that ends in .exr", options.output));
    }
    const std::filesystem::path png = std::filesystem::path(exr).replace_extension(".png");
    check_denoise(options.is_denoised);
    check_output_name(exr);
    check_output_name(png);
    check_json_name(options.common);
    std::vector<Part> parts;
    std::ranges::transform(options.files, std::back_inserter(parts), look_at);
    const ShardSet shards = united(parts);
    const std::vector<int> missing = shards.missing();
    if (!missing.empty() && !options.takes_some) {
        throw InputError(fmt::format("{} of {} shards are missing: {}; expected all of them, or --partial",
                                     missing.size(), shards.count, shard_list(missing, ", ")));
    }
    render::FilmFile sum = sum_of(std::move(parts));
    sum.notes.has_digest = options.has_digest || !missing.empty();
    if (missing.empty()) {
        sum.notes.metadata.erase(kShardNote);
    } else {
        sum.notes.metadata[kShardNote] = shard_set_text(shards);
    }
    const render::Picture picture(sum.films);
    render::write_film_exr(picture, sum.notes, exr);
    formats::write_png(render::film_rgb(picture), png);
    const std::optional<RawFiles> raw = write_raw_files(picture, sum.notes, exr, options.common.threads);
    Json json = {{"shards", shards.indices}, {"missing", missing}, {"exr", exr.string()}, {"png", png.string()}};
    report_left_out(picture, json);
    if (prints_text(options.common)) {
        print("{}\n{}\n", exr.string(), png.string());
    }
    if (raw) {
        report_raw_files(*raw, json, options.common);
    }
    if (options.is_denoised) {
        write_denoised(picture, sum.notes, exr, json, options.common);
    }
    write_json_result(options.common, json);
    return kDone;
}

}  // namespace

void add_merge_command(Program& program) {
    const auto options = std::make_shared<MergeOptions>();
    Command command = program.add_command("merge", "Add up the shards of a render");
    command.footer("Example: lensproof merge part1.exr part2.exr part3.exr -o chart.exr");
    command.add_option("SHARD", options->files, "What `render --shard` wrote, in any order").required();
    command.add_option("-o,--output", options->output, "EXR to write; a PNG appears beside it")
        .type_name("FILE")
        .required();
    command.add_flag("--partial", options->takes_some,
                     "Take the shards that there are; the result merges further as a shard");
    command.add_flag("--digest", options->has_digest, "Also write a digest of all pixels, as shards have it");
    add_denoise_option(command, options->is_denoised);
    add_common_options(command, options->common);
    command.runs([options] { return run_merge(*options); });
}

}  // namespace lensproof::cli
