// engine/optics/front_dust.h — dust and scratches on the front of a lens.
#pragma once
#include <memory>

#include "engine/base/ray.h"
#include "engine/optics/prescription.h"

namespace lensproof::optics {

template <class T>
struct TraceLens;

/// A sheet of grains just before the first surface, in the air: where it covers the glass, light that comes from either
/// side is absorbed or scattered as Lambert's law has it, to either side. Of light that the glass under a grain sends
/// back that grain has its share again.
struct FrontDust {
    std::shared_ptr<const ApertureTexture> covered;  // 0: clean, 1: wholly covered
    double semi_diameter = 0.0;                      // of the first surface, mm
    double albedo = 0.0;                             // 0 to 1: the fraction that is scattered
    double through = 0.5;                            // 0 to 1: of that, on to the other side

    /// What a point of the first surface (lens space, mm) lets pass by, 0 to 1.
    [[nodiscard]] double clear(const Vec3d& front) const {
        return 1.0 - covered->at(front.x / semi_diameter, front.y / semi_diameter);
    }
    /// What a ray into the lens finds there; 1 where it does not meet the first surface.
    [[nodiscard]] double clear(const Ray<double>& ray, const TraceLens<double>& lens) const;
};

}  // namespace lensproof::optics
