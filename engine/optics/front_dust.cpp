#include "engine/optics/front_dust.h"

#include "engine/optics/ghost_path.h"

namespace lensproof::optics {

double FrontDust::clear(const Ray<double>& ray, const TraceLens<double>& lens) const {
    TravellingRay<double> at_front{.origin = ray.origin, .direction = ray.direction};
    const RayStatus status = run_to_surface<Rims::clip>(lens, 0, true, AtSurface::pass, {}, at_front).first;
    return status == RayStatus::missed || status == RayStatus::clipped ? 1.0 : clear(at_front.global().origin);
}

}  // namespace lensproof::optics
