// calibration/sharpness/edge_alignment.h — the pixels around an edge, by their distance from it.
#pragma once
#include <variant>
#include <vector>

#include "calibration/sharpness/slanted_edge.h"

namespace lensproof::calibration {

struct EdgePixel {
    double along = 0.0;   // px, from the region's middle
    double across = 0.0;  // px, from its axis, positive on the bright side
    double value = 0.0;
    double distance = 0.0;  // from the edge, px
};

struct AlignedEdge {
    std::vector<EdgePixel> pixels;
    Vec2d centre_px;  // of the edge
    Vec2d normal;     // towards the bright side
    double half_length_px = 0.0;
    double half_width_px = 0.0;
    double rise_px = 0.0;  // 10 % to 90 %
    double bend_px = 0.0;
};

/// Fits the edge's place in the region: distance = across − Σ θ_j P_j(along / half length) with Legendre's P_0 … P_3.
std::variant<AlignedEdge, EdgeRefusal> align_edge(const formats::Image& image, int channel, const EdgeRegion& region);

/// Means over bins of equal width in distance, from `-0.5 * bins * width` on.
struct EdgeProfile {
    double width = 0.0;
    std::vector<double> mean;
    std::vector<int> count;

    /// The middle of bin `k`.
    [[nodiscard]] double middle(std::size_t k) const {
        return (static_cast<double>(k) + 0.5 - 0.5 * static_cast<double>(mean.size())) * width;
    }
    /// The bin that holds `distance`; -1 outside.
    [[nodiscard]] int bin(double distance) const;
    /// d(mean)/d(distance) around bin `k`.
    [[nodiscard]] double slope(std::size_t k) const;
};

/// Means are moved from where their pixels lie to the middle of their bin; empty bins take their neighbours' line.
EdgeProfile edge_profile(const std::vector<EdgePixel>& pixels, double half_width, double bin_width);

}  // namespace lensproof::calibration
