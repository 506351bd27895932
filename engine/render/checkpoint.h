// engine/render/checkpoint.h — a render's state on disk, so that what ends it costs the last minutes alone.
#pragma once
#include <filesystem>
#include <span>

#include "engine/render/film/render_identity.h"
#include "engine/render/progressive.h"

namespace lensproof::render {

/// Writes all that a render needs to go on to the same bits: every sum in double, and which samples are in them. The
/// file appears whole or not at all, also where the power fails.
void write_checkpoint(const std::filesystem::path& file, const RenderIdentity& identity,
                      std::span<const RenderState> passes);

/// Takes films and tiles from the checkpoint. `passes` are the beginning of the render that wants to go on, and
/// untouched where an InputError is thrown: the file is missing, damaged (a digest of all of it says so), or of another
/// render — another identity, layout, or first sample. The end of the range may be another one.
void read_checkpoint(const std::filesystem::path& file, const RenderIdentity& identity, std::span<RenderState> passes);

}  // namespace lensproof::render
