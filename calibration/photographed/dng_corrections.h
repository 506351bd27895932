// calibration/photographed/dng_corrections.h — a lens as its maker corrects it, from a DNG's opcodes.
#pragma once
#include <filesystem>
#include <optional>

#include "calibration/photographed/photographed_lens.h"

namespace lensproof::calibration {

/// The corrections that a DNG's raw picture carries, in a photographed lens's terms: it is the lens that needs them.
/// About their own centre; tangential terms are left out, with a remark. A gain that follows a warp is taken as if it
/// came before. The sensor's size is that of `crop_factor`, else of the EXIF's focal-plane resolution, else of its
/// focal lengths.
/// Throws InputError naming `dng` where it is none, says nothing of its lens or of its sensor's size, or as
/// read_opcodes does.
PhotographedLens read_dng_corrections(const std::filesystem::path& dng, std::optional<double> crop_factor = {});

}  // namespace lensproof::calibration
