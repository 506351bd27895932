// engine/render/film_points.h — film points moved from even over their pixel to where its filter draws them.
#pragma once
#include "engine/render/packet/path_chunk.h"
#include "engine/render/sampling/pixel_filter.h"

namespace lensproof::render {

/// Film points are even over their pixel so far; where in it makes the number that the filter's draw takes. `weights`:
/// what each then counts. Those of the box stay as they are.
void draw_from_filter(const PixelFilter& filter, const Sensor& sensor, PathStarts& starts, PathColumn<double>& weights);

}  // namespace lensproof::render
