// experiments/cli/denoised_files.h — a picture without its noise, beside the picture.
#pragma once
#include <filesystem>

#include "engine/base/json.h"
#include "engine/render/film/film_exr.h"
#include "experiments/cli/command.h"

namespace lensproof::cli {

/// Adds `--denoise`.
void add_denoise_option(Command& command, bool& is_denoised);

/// Throws InputError where the program cannot denoise: to be asked before long work begins.
void check_denoise(bool is_denoised);

/// Writes NAME.denoised.exr and NAME.denoised.png beside NAME.exr, guided by albedo and normals where the film has
/// them, and says so: keys of a machine-readable result, and where a person reads it.
void write_denoised(const render::Picture& picture, const render::FilmNotes& notes, const std::filesystem::path& exr,
                    Json& json, const CommonOptions& common);

}  // namespace lensproof::cli
