// engine/formats/prescription/seq_shape.h — the commands of a CODE V sequence file that say how a surface is bent, what
// it diffracts, and where it stands.
#pragma once
#include <cstddef>

#include "engine/formats/prescription/design_command.h"
#include "engine/formats/prescription/seq_file.h"

namespace lensproof::formats {

/// A command of a surface.
struct SeqSurfaceCommand {
    const Command& here;
    std::size_t next = 1;  // its first word behind the qualifiers
    int surface = 0;       // its number in the file
    Remarks& remarks;
};

/// Takes what the command says of the surface's shape. False: it says nothing of it.
bool read_seq_shape(const SeqSurfaceCommand& command, SeqSurface& surface);

}  // namespace lensproof::formats
