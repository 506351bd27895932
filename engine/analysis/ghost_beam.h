// engine/analysis/ghost_beam.h — the light of a distant source that meets the front of a lens, and where it lands along
// a ghost.
#pragma once
#include <array>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "engine/optics/ghost_path.h"

namespace lensproof::analysis {

/// Parallel rays over the whole first surface, told apart by their offset (mm) across the light in the square that
/// holds them all.
class FrontBeam {
  public:
    /// `angle` (radians) from the axis, the light's way rising towards +y.
    FrontBeam(const optics::TraceLens<double>& lens, double angle);

    [[nodiscard]] constexpr Ray<double> ray(Vec2d offset) const {
        // From well in front: a dome's light from the side first meets it there.
        return {offset.x * across_[0] + offset.y * across_[1] - 2.0 * side_ * direction_, direction_};
    }
    [[nodiscard]] Vec2d corner() const { return corner_; }
    [[nodiscard]] double side() const { return side_; }
    [[nodiscard]] double area() const { return side_ * side_; }

  private:
    Vec3d direction_;
    std::array<Vec3d, 2> across_;
    Vec2d corner_;
    double side_ = 0.0;
};

class GhostDevice;

/// What a ghost is measured with.
struct GhostScene {
    optics::TraceLens<double> lens;
    FrontBeam beam;
    optics::StrayMirrors<double> mirrors;
    double image_radius = 0.0;  // of the image circle, in which light counts, mm
    double pupil_area = 0.0;    // of the light that enters the entrance pupil: a cross-section of the beam, mm²
    std::shared_ptr<GhostDevice> device{};  // that traces many rays through this very lens; null: the processors do
};

/// A ray that reached the image circle.
struct Landing {
    Vec2d point;                 // on the image plane, mm
    double transmittance = 0.0;  // all that was passed and reflected on the way
};

/// Where the ray of the light at `offset` lands; nothing where it does not. Of an empty path: of the image.
std::optional<Landing> landing(const GhostScene& scene, const optics::GhostPath& path, Vec2d offset);
/// The same of many.
std::vector<std::optional<Landing>> landings(const GhostScene& scene, const optics::GhostPath& path,
                                             std::span<const Vec2d> offsets);

/// How far a ray stands from each limit that it has to keep to, in the order met: r / semi-diameter − 1 at surfaces
/// that it passes, past every rim, the opposite at blades that are to reflect it, and last r / radius − 1 at the image
/// circle. Each changes smoothly from ray to ray, and where the ray lands none is above 0.
struct LandingMargins {
    std::vector<double> margins;
    bool arrives = false;  // at the image plane; else the ray ends behind the last of these
};
std::vector<LandingMargins> landing_margins(const GhostScene& scene, const optics::GhostPath& path,
                                            std::span<const Vec2d> offsets);

/// A ray followed past rims: where it would land, and the largest of its margins, above 0 where it does not.
struct RimRay {
    Vec2d point;
    double transmittance = 0.0;
    double margin = 0.0;
    bool arrives = false;  // at the image plane; else the margin is that of the limits that it met
};
std::vector<RimRay> rim_rays(const GhostScene& scene, const optics::GhostPath& path, std::span<const Vec2d> offsets);

}  // namespace lensproof::analysis
