// engine/render/camera/packet/ideal_path.h — from the film through a camera without aberrations.
#pragma once
#include <vector>

#include "engine/base/disc.h"
#include "engine/base/ray.h"

namespace lensproof::render {

/// First-order optics (gaussian_optics.h) as paths from the film take them.
template <class T>
struct IdealOptics {
    T to_pupil_z;     // from the film's plane to the pupil's, mm
    T pupil_radius;   // of the disc that paths cross, mm; 0 of a pinhole
    T pupil_area;     // that they count for, mm²
    T object_z;       // where their rays begin
    T h_h, h_s;       // height there, of height and slope at the pupil
    T s_h, s_s;       // and slope
    T transmittance;  // of the lens
};

template <class T>
struct IdealPath {
    Ray<T> ray;  // lens space, away from the camera, of unit length
    T weight;    // τ cos⁴θ / Z² · the pupil's area, sr
};

/// The path of a film point and two numbers in [0, 1).
///
/// T: double, or a packet of them; every lane has the bits of the double.
template <class T>
IdealPath<T> ideal_path(const IdealOptics<T>& optics, const Vec2<T>& film, const T& u, const T& v) {
    using std::sqrt;
    const Vec2<T> h = warped_onto_disc(optics.pupil_radius, u, v);
    const Vec3<T> to_pupil{h.x - film.x, h.y - film.y, optics.to_pupil_z};
    const T per_z = T(1.0) / optics.to_pupil_z;
    const Vec2<T> s{to_pupil.x * per_z, to_pupil.y * per_z};
    const Vec2<T> slope{optics.s_h * h.x + optics.s_s * s.x, optics.s_h * h.y + optics.s_s * s.y};
    const T per_length = T(1.0) / sqrt(dot(slope, slope) + T(1.0));
    const T z_per_distance2 = optics.to_pupil_z / dot(to_pupil, to_pupil);
    return {.ray = {{optics.h_h * h.x + optics.h_s * s.x, optics.h_h * h.y + optics.h_s * s.y, optics.object_z},
                    {-per_length * slope.x, -per_length * slope.y, -per_length}},
            .weight = optics.transmittance * z_per_distance2 * z_per_distance2 * optics.pupil_area};
}

/// Those of several wavelengths, a column a number.
using IdealOpticsColumns = IdealOptics<std::vector<double>>;

}  // namespace lensproof::render
