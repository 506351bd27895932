// engine/render/camera/packet/aim.h — from the film through the pupil: the ray that a camera path begins with.
#pragma once
#include "engine/base/select.h"
#include "engine/base/vec.h"

namespace lensproof::render {

template <class T>
struct AimedRay {
    Vec3<T> direction;  // as optics::reverse_ray has it, z < 0
    T etendue;          // cos⁴θ / Z² · the area that the pupil point was drawn from, sr
};

/// `to_pupil_z`: from the film's plane to the pupil's, mm.
///
/// T: double, or a packet of them; every lane has the bits of the double.
template <class T>
constexpr AimedRay<T> aim(const Vec2<T>& film, const Vec2<T>& pupil, const T& to_pupil_z, const T& pupil_area) {
    using std::sqrt;
    const Vec3<T> to_pupil{pupil.x - film.x, pupil.y - film.y, to_pupil_z};
    const T heading = select(to_pupil_z < T(0), T(1), T(-1));
    const T per_distance2 = T(1) / dot(to_pupil, to_pupil);
    const Vec3<T> direction = heading * sqrt(per_distance2) * to_pupil;
    return {direction, direction.z * direction.z * per_distance2 * pupil_area};
}

}  // namespace lensproof::render
