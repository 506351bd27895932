// experiments/draw/sharpness_plots.h — where a picture is how sharp: as a map, and written on the picture itself.
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "engine/base/vec.h"
#include "experiments/draw/frame_map.h"

namespace lensproof::draw {

/// An edge that was measured. Pixels as in engine/formats/image/image.h.
struct MarkedEdge {
    Vec2d centre_px;
    double normal_deg = 0.0;  // from +x towards +y
    double length_px = 0.0;   // of the part that was measured, along the edge,
    double width_px = 0.0;    // and across it
    double mtf50_cycles_per_px = 0.0;
};

/// The range of colours for some edges: from their 5th to their 95th percentile, rounded outwards.
AxisRange sharpness_range(const std::vector<MarkedEdge>& edges);

/// MTF50 over the frame (cycles per pixel) as colours over `range`, and the edges that it comes from as lines that lie
/// as they do.
std::string sharpness_map_svg(const FrameMap& mtf50, const std::vector<MarkedEdge>& edges, const AxisRange& range);

/// A picture (the bytes of a PNG, of any size) of a frame that large, with each edge outlined in the colour of its
/// MTF50 and the number beside it.
std::string marked_edges_svg(const std::string& title, int width_px, int height_px, std::string_view png,
                             const std::vector<MarkedEdge>& edges, const AxisRange& range);

}  // namespace lensproof::draw
