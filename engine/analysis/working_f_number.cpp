#include "engine/analysis/working_f_number.h"

#include <cmath>

#include "engine/optics/meridional_bundle.h"

namespace lensproof::analysis {

double real_working_f_number(const optics::TraceLens<double>& lens, double object_distance) {
    const double first_vertex_z = lens.surfaces.front().vertex_z;
    const optics::ChiefRay axis{
        .field_angle = 0.0, .front = {{0.0, 0.0, first_vertex_z}, {0.0, 0.0, 1.0}}, .image_height = 0.0};
    const optics::MeridionalBundle bundle = optics::meridional_bundle(lens, axis, object_distance - first_vertex_z);
    const double sine_upper = optics::trace(lens, bundle.ray({0.0, bundle.upper})).ray.direction.y;
    const double sine_lower = optics::trace(lens, bundle.ray({0.0, bundle.lower})).ray.direction.y;
    return 1.0 / std::abs(lens.surfaces.back().index_after * (sine_upper - sine_lower));
}

}  // namespace lensproof::analysis
