// engine/optics/barrel.h — what scatters in a lens: the walls inside, which are tubes between elements, edges of
// elements, mounts and the stop's blades; and the dust on its front.
#pragma once
#include <optional>
#include <vector>

#include "engine/optics/lens.h"
#include "engine/optics/wall_finish.h"

namespace lensproof::optics {

/// Where a ray meets a wall.
struct WallMeeting {
    double distance = 0.0;  // mm
    Vec3d normal;           // of unit length, inwards
    WallFinish finish;
    bool is_blades = false;  // of a stop that is no face of glass
};

class Barrel {
  public:
    /// Of a lens of surfaces of revolution about one axis, as it is focused and stopped down. A surface ends at its
    /// clear aperture. Between there and the tube stands its mount, and beyond the stop's opening the blades. What a
    /// tube measures a prescription's `barrel_mm` says; else it runs from rim to rim (`rim_mm`, or the clear aperture
    /// where there is none), as edges of elements do. Throws InputError for other lenses, unless all walls are black.
    explicit Barrel(const Lens& lens);

    /// The nearest wall ahead of a ray inside cell `cell`: that between surfaces `cell` − 1 and `cell`, from 0. Nothing
    /// where the ray meets none: it leaves through a surface, or the table's rims overlap.
    [[nodiscard]] std::optional<WallMeeting> meet(int cell, const Ray<double>& ray) const;

    [[nodiscard]] const BarrelFinish& finish() const { return finish_; }
    /// What lies on the first surface, or null.
    [[nodiscard]] const FrontDust* dust() const { return dust_ ? &*dust_ : nullptr; }
    /// Whether light that meets any of it ends there.
    [[nodiscard]] bool is_black() const { return finish_.is_black() && !(dust_ && dust_->albedo > 0.0); }

  private:
    struct Ring {
        double z = 0.0;
        double inner = 0.0;
        double outer = 0.0;
        WallFinish finish;
        bool is_blades = false;
    };
    /// A space between two successive surfaces.
    struct Cell {
        Ring front;  // faces the sensor,
        Ring rear;   // faces the scene; between their outer edges:
        WallFinish around;
    };

    BarrelFinish finish_;
    std::optional<FrontDust> dust_;
    std::vector<Cell> cells_;  // behind surface 0, 1, …
};

}  // namespace lensproof::optics
