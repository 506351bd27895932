// engine/optics/lens_bytes.h — all that a ray meets in a lens, as bytes: what is derived from a lens is kept by them.
#pragma once
#include <string>

#include "engine/optics/trace.h"

namespace lensproof::optics {

/// Appends every number of the lens, coatings, masks and textures included. Two lenses leave the same bytes only where
/// they are the same to the last bit.
void append_lens_bytes(std::string& bytes, const TraceLens<double>& lens);

}  // namespace lensproof::optics
