#include "engine/optics/paraxial_ghost.h"

#include <cmath>
#include <numbers>

#include "engine/base/infinity.h"

namespace lensproof::optics {

ParaxialGhost paraxial_ghost(const TraceLens<double>& lens, const GhostPath& path, double field_angle) {
    const auto [stop, image] = folded_system(lens, path);
    const double diameter = paraxial_data(lens).entrance_pupil_diameter;
    const auto ratio = [](double a, double b) { return b == 0.0 ? kInfinity : a / b; };
    ParaxialGhost ghost;
    ghost.marginal_ray_height = 0.5 * diameter * image.a;
    if (stop.a != 0.0 && std::abs(field_angle) < 0.5 * std::numbers::pi) {
        ghost.chief_ray_height = std::tan(field_angle) * (image.b - image.a * stop.b / stop.a);
    }
    ghost.efl = ratio(-1.0, image.c);
    ghost.focus = ratio(-image.a, image.c);
    // Of a ray through the stop's centre, times `stop.a`, so that one from infinity far beside the axis counts too.
    ghost.pupil = ratio(image.a * stop.b - image.b * stop.a, image.d * stop.a - image.c * stop.b);
    ghost.f_number = std::isinf(ghost.efl) ? kInfinity : ghost.efl / diameter;
    return ghost;
}

}  // namespace lensproof::optics
