// engine/optics/stop_mask.h — what a stop that is no full circle lets through.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "engine/optics/prescription.h"

namespace lensproof::optics {

/// The part of a stop's circle that is open, at a given semi-diameter.
class StopMask {
  public:
    /// The full circle.
    StopMask() = default;

    /// Throws InputError naming a texture's picture that was not read.
    explicit StopMask(const StopShape& shape);

    [[nodiscard]] bool is_full_circle() const { return arcs_.empty() && !texture_; }

    /// The transmittance, 0 to 1, at a point of the stop's plane in units of its semi-diameter, inside the unit circle.
    [[nodiscard]] double transmittance(double x, double y) const;

    /// How far a point stands inside (≤ 0) or outside (> 0) the blade's edge that is nearest to being crossed, and
    /// which that is, from 0: smooth along each edge. A texture has no edges but where it is dark: an infinite margin
    /// there, −1 elsewhere.
    struct EdgeMargin {
        double margin = -1.0;
        int edge = 0;
    };
    [[nodiscard]] EdgeMargin edge_margin(double x, double y) const;

    /// Appends all that tells this mask from another.
    void append_to(std::string& bytes) const;

  private:
    /// An edge of the polygon: the disc (curved blade) or half plane (straight) that it bounds.
    struct Arc {
        double x = 0.0;  // towards the middle of the edge, a unit vector
        double y = 0.0;
        double centre = 0.0;          // along it, of the disc
        double radius_squared = 0.0;  // of the disc; 0: the half plane up to `centre`

        [[nodiscard]] double margin(double at_x, double at_y) const;  // ≤ 0 inside
    };

    std::vector<Arc> arcs_;
    std::shared_ptr<const StopTexture> texture_;
};

}  // namespace lensproof::optics
