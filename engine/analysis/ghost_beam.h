// engine/analysis/ghost_beam.h — the light of a distant source that meets the front of a lens, and where it lands along
// a ghost.
#pragma once
#include <array>
#include <optional>
#include <vector>

#include "engine/optics/ghost_path.h"

namespace lensproof::analysis {

/// Parallel rays over the whole first surface, told apart by their offset (mm) across the light in the square that
/// holds them all.
class FrontBeam {
  public:
    /// `angle` (radians) from the axis, the light's way rising towards +y.
    FrontBeam(const optics::TraceLens<double>& lens, double angle);

    [[nodiscard]] Ray<double> ray(Vec2d offset) const;
    [[nodiscard]] Vec2d corner() const { return corner_; }
    [[nodiscard]] double side() const { return side_; }
    [[nodiscard]] double area() const { return side_ * side_; }

  private:
    Vec3d direction_;
    std::array<Vec3d, 2> across_;
    Vec2d corner_;
    double side_ = 0.0;
};

/// What a ghost is measured with.
struct GhostScene {
    optics::TraceLens<double> lens;
    FrontBeam beam;
    optics::StrayMirrors<double> mirrors;
    double image_radius = 0.0;  // of the image circle, in which light counts, mm
    double pupil_area = 0.0;    // of the light that enters the entrance pupil: a cross-section of the beam, mm²
};

/// A ray that reached the image circle.
struct Landing {
    Vec2d point;           // on the image plane, mm
    double transmittance;  // all that was passed and reflected on the way
};

/// Where the ray of the light at `offset` lands; nothing where it does not. Of an empty path: of the image.
std::optional<Landing> landing(const GhostScene& scene, const optics::GhostPath& path, Vec2d offset);

/// How far a ray stands from each limit that it has to keep to, in the order met: r / semi-diameter − 1 at surfaces
/// that it passes, past every rim, the opposite at blades that are to reflect it, and last r / radius − 1 at the image
/// circle. Each changes smoothly from ray to ray, and where the ray lands none is above 0.
struct LandingMargins {
    std::vector<double> margins;
    bool arrives = false;  // at the image plane; else the ray ends behind the last of these
};
LandingMargins landing_margins(const GhostScene& scene, const optics::GhostPath& path, Vec2d offset);

/// A ray followed past rims: where it would land, and the largest of its margins, above 0 where it does not.
struct RimRay {
    Vec2d point;
    double transmittance = 0.0;
    double margin = 0.0;
    bool arrives = false;  // at the image plane; else the margin is that of the limits that it met
};
void rim_rays(const GhostScene& scene, const optics::GhostPath& path, const std::vector<Vec2d>& offsets,
              std::vector<RimRay>& rays);

}  // namespace lensproof::analysis
