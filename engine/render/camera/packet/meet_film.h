// engine/render/camera/packet/meet_film.h — from a ray behind the lens back to the film: what aim.h does, undone.
#pragma once
#include "engine/base/ray.h"

namespace lensproof::render {

/// Where a ray behind the lens crosses the planes of film and pupil, lens space, mm.
template <class T>
struct FilmCrossing {
    Vec2<T> film;
    Vec2<T> pupil;
    T per_etendue;  // Z² / cos⁴θ, mm²/sr: makes of a pdf over the pupil one over the etendue, times a pixel's area
};

/// T: double, or a packet of them; every lane has the bits of the double. The direction may have any length.
template <class T>
constexpr FilmCrossing<T> cross_film(const Ray<T>& behind, const T& film_z, const T& pupil_z) {
    const Vec3<T>& d = behind.direction;
    const T per_z = T(1) / d.z;
    const auto crossing = [&](const T& z) {
        const T along = (z - behind.origin.z) * per_z;
        return Vec2<T>{behind.origin.x + along * d.x, behind.origin.y + along * d.y};
    };
    const T between = film_z - pupil_z;
    const T distance_over_cosine = between * (dot(d, d) * per_z * per_z);
    return {crossing(film_z), crossing(pupil_z), distance_over_cosine * distance_over_cosine};
}

}  // namespace lensproof::render
