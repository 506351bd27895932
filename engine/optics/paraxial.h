// engine/optics/paraxial.h — first-order data of a lens at one wavelength.
#pragma once
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <type_traits>

#include "engine/optics/trace.h"

namespace lensproof::optics {

// T: double, long double or a multiprecision number, as the lens has it. Only the curvature at each vertex counts (that
// of a toroid in y–z, an r² term included); tilts and decentres are left out. The lens has one stop. Distances are
// signed, as at mirrors the tracer's indices are.
//
// Nothing here is NaN: what lies at infinity is infinite, and its sign means nothing where it is not stated.

/// Height (mm) and slope (dy/dz) of a paraxial ray.
template <class T>
struct BasicParaxialRay {
    T height = T(0);
    T slope = T(0);
};

/// Gaussian optics of a lens (Welford, Aberrations of Optical Systems, ch. 3); mm.
///
/// An afocal lens has an infinite `efl` and `f_number`, and its focal, principal and nodal points lie at infinity. A
/// pupil at infinity (the stop in a focal plane of what lies on its side) has an infinite diameter.
template <class T>
struct BasicParaxialData {
    T efl = T(0);                      // effective (rear) focal length |n'| / K, positive for a camera lens
    T front_efl = T(0);                // n / K: paraxial image height over the tangent of the field angle
    T bfl = T(0);                      // last vertex to rear focal point
    T ffl = T(0);                      // first vertex to front focal point, negative in front of it
    T entrance_pupil_z = T(0);         // from the first vertex
    T entrance_pupil_diameter = T(0);  // image of the whole stop
    T exit_pupil_z = T(0);             // from the last vertex
    T exit_pupil_diameter = T(0);
    T f_number = T(0);           // efl / entrance_pupil_diameter
    T front_principal_z = T(0);  // from the first vertex
    T rear_principal_z = T(0);   // from the last vertex
    T front_nodal_z = T(0);      // from the first vertex; the principal point where both ends have one index
    T rear_nodal_z = T(0);       // from the last vertex
    // −1 / (n' Σ c (n' − n) / (n n')), of the surface on which a flat object's image lies where there is no
    // astigmatism: negative where its centre lies at smaller z, towards a lens, infinite where it is flat.
    T petzval_radius = T(0);
};

/// What depends on where the object is.
template <class T>
struct BasicConjugates {
    T image_distance = T(0);  // last vertex to paraxial image, mm
    T magnification = T(0);   // transverse, negative where the image is inverted; of an object at infinity 0
    // Of the paraxial ray through the stop's edge: 1 / (2 |n' u'|), u' being a slope (a tangent). With an object at
    // infinity this is the f-number's size; of a lens without coma the real 1 / (2 n' sin U') is the same.
    T working_f_number = T(0);
    T object_numerical_aperture = T(0);  // n |u| of that ray, to be read as a sine likewise
};

using ParaxialRay = BasicParaxialRay<double>;
using ParaxialData = BasicParaxialData<double>;
using Conjugates = BasicConjugates<double>;

/// A paraxial ray that stands at surface `first` (just before it) and is followed to just behind surface `last`;
/// surfaces are counted from 0. With last < first it is followed backwards, from just behind `first` to just before
/// `last`.
template <class T>
BasicParaxialRay<T> trace_paraxial(const TraceLens<T>& lens, BasicParaxialRay<T> ray, int first, int last);

/// The lens's first-order data; the stop's opening is its semi-diameter.
template <class T>
BasicParaxialData<T> paraxial_data(const TraceLens<T>& lens);

/// Distance from the last vertex to the paraxial image of an object `object_distance` mm in front of the first vertex,
/// which may be infinite, 0, or negative (light that converges).
template <class T>
T paraxial_image_distance(const TraceLens<T>& lens, const std::type_identity_t<T>& object_distance);

/// Image, magnification and apertures for an object as above. Where the object's image falls into the stop, which then
/// limits no cone of light, the working f-number is 0, and the numerical aperture infinite if the object is near.
template <class T>
BasicConjugates<T> paraxial_conjugates(const TraceLens<T>& lens, const std::type_identity_t<T>& object_distance);

/// The marginal ray just before the first surface: from the axial object point through the edge of the stop, the one
/// whose image in the entrance pupil lies at +y. Nothing where the object's image falls into the stop, or the stop has
/// no finite semi-diameter.
template <class T>
std::optional<BasicParaxialRay<T>> paraxial_marginal_ray(const TraceLens<T>& lens,
                                                         const std::type_identity_t<T>& object_distance);

/// The chief ray just before the first surface: through the stop's centre, with slope tan(field_angle). Nothing at or
/// beyond 90°, which a paraxial ray does not reach, and where the entrance pupil lies at infinity.
template <class T>
std::optional<BasicParaxialRay<T>> paraxial_chief_ray(const TraceLens<T>& lens,
                                                      const std::type_identity_t<T>& field_angle);

/// Lagrange's invariant n (y ū − ȳ u) of the marginal and the chief ray, mm, with the field's sign: n tan θ times half
/// the entrance pupil's diameter, wherever the object is. Nothing where there is no chief ray or no marginal ray.
template <class T>
std::optional<T> lagrange_invariant(const TraceLens<T>& lens, const std::type_identity_t<T>& field_angle);

// ---------------------------------------------------------------------------------------------------------------------

namespace paraxial_detail {

template <class T>
T infinity() {
    return std::numeric_limits<T>::infinity();
}

/// What a surface's thin element adds, 1/mm.
template <class T>
T thin_power(const TraceLens<T>& lens, const TraceSurface<T>& surface) {
    return surface.special < 0 ? T(0)
                               : lens.specials[static_cast<std::size_t>(surface.special)].thin.first_order_power();
}

template <class T>
T refracting_power(const TraceSurface<T>& surface) {
    return surface.curvature * (surface.index_after - surface.index_before);
}

template <class T>
T power(const TraceLens<T>& lens, const TraceSurface<T>& surface) {
    return refracting_power(surface) + thin_power(lens, surface);
}

template <class T>
BasicParaxialRay<T> refracted(const TraceLens<T>& lens, const BasicParaxialRay<T>& ray,
                              const TraceSurface<T>& surface) {
    return {ray.height, (surface.index_before * ray.slope - ray.height * power(lens, surface)) / surface.index_after};
}

template <class T>
BasicParaxialRay<T> refracted_backwards(const TraceLens<T>& lens, const BasicParaxialRay<T>& ray,
                                        const TraceSurface<T>& surface) {
    return {ray.height, (surface.index_after * ray.slope + ray.height * power(lens, surface)) / surface.index_before};
}

/// Where a ray in the plane of a vertex crosses the axis, from that vertex.
template <class T>
T axis_crossing(const BasicParaxialRay<T>& ray) {
    return ray.slope == T(0) ? infinity<T>() : T(-ray.height / ray.slope);
}

template <class T>
int find_stop(const TraceLens<T>& lens) {
    return static_cast<int>(std::ranges::find_if(lens.surfaces, &TraceSurface<T>::is_stop) - lens.surfaces.begin());
}

template <class T>
T stop_semi_diameter(const TraceLens<T>& lens) {
    using std::sqrt;
    return sqrt(lens.surfaces[find_stop(lens)].semi_diameter_squared);
}

/// A ray from the axial object point, just before the first surface: of unit height, or unit slope where it is near.
template <class T>
BasicParaxialRay<T> ray_from_axis(const T& object_distance) {
    using std::abs;
    if (abs(object_distance) < T(1)) {
        return {object_distance, T(1)};
    }
    return {T(1), T(1) / object_distance};  // 0 for infinity
}

/// The ray from the stop's centre of optical slope 1, as it stands just before the first surface.
template <class T>
BasicParaxialRay<T> ray_from_stop_to_front(const TraceLens<T>& lens) {
    const int stop = find_stop(lens);
    BasicParaxialRay<T> ray{T(0), T(1) / lens.surfaces[stop].index_before};
    for (int i = stop; i > 0; --i) {
        ray.height -= ray.slope * (lens.surfaces[i].vertex_z - lens.surfaces[i - 1].vertex_z);
        ray = refracted_backwards(lens, ray, lens.surfaces[i - 1]);
    }
    return ray;
}

/// The whole lens as a matrix: a ray of height y and optical slope n u in the first vertex's plane leaves the last with
///     y' = A y + B n u,   n' u' = D n u − K y
/// (Gauss). A − 1 and D − 1 are summed up themselves, so that the principal points keep their digits where the lens is
/// weak, and conjugates theirs where it is nearly afocal and the object far.
template <class T>
struct GaussianConstants {
    T height_change = T(0);  // A − 1
    T slope_change = T(0);   // D − 1
    T reduced_path = T(0);   // B
    T power = T(0);          // K
    T n_first = T(1);
    T n_last = T(1);

    [[nodiscard]] BasicParaxialRay<T> through(const BasicParaxialRay<T>& ray) const {
        const T optical_slope = n_first * ray.slope;
        return {ray.height + height_change * ray.height + reduced_path * optical_slope,
                (optical_slope + slope_change * optical_slope - power * ray.height) / n_last};
    }
};

template <class T>
GaussianConstants<T> gaussian_constants(const TraceLens<T>& lens) {
    GaussianConstants<T> constants;
    constants.n_first = lens.surfaces.front().index_before;
    constants.n_last = lens.surfaces.back().index_after;
    BasicParaxialRay<T> parallel{T(1), T(0)};
    BasicParaxialRay<T> through_vertex{T(0), T(1) / constants.n_first};
    T z = lens.surfaces.front().vertex_z;
    for (const TraceSurface<T>& surface : lens.surfaces) {
        const T gap = surface.vertex_z - z;
        z = surface.vertex_z;
        constants.height_change += gap * parallel.slope;
        parallel.height = T(1) + constants.height_change;
        through_vertex.height += gap * through_vertex.slope;
        constants.power += parallel.height * power(lens, surface);
        constants.slope_change -= through_vertex.height * power(lens, surface);
        parallel = refracted(lens, parallel, surface);
        through_vertex = refracted(lens, through_vertex, surface);
    }
    constants.reduced_path = through_vertex.height;
    return constants;
}

template <class T>
void set_cardinal_points(BasicParaxialData<T>& data, const TraceLens<T>& lens) {
    using std::abs;
    const GaussianConstants<T> constants = gaussian_constants(lens);
    const T& n_first = constants.n_first;
    const T& n_last = constants.n_last;
    const T& power = constants.power;
    if (power == T(0)) {
        data.efl = data.front_efl = data.bfl = data.rear_principal_z = data.rear_nodal_z = infinity<T>();
        data.ffl = data.front_principal_z = data.front_nodal_z = -infinity<T>();
        return;
    }
    data.efl = abs(n_last) / power;
    data.front_efl = n_first / power;
    data.bfl = n_last * (T(1) + constants.height_change) / power;
    data.ffl = -n_first * (T(1) + constants.slope_change) / power;
    data.front_principal_z = -n_first * constants.slope_change / power;
    data.rear_principal_z = n_last * constants.height_change / power;
    const T principal_to_nodal = (n_last - n_first) / power;
    data.front_nodal_z = data.front_principal_z + principal_to_nodal;
    data.rear_nodal_z = data.rear_principal_z + principal_to_nodal;
}

template <class T>
T petzval_radius(const TraceLens<T>& lens) {
    T sum = T(0);
    for (const TraceSurface<T>& surface : lens.surfaces) {
        // Neither an ideal lens, by its nature, nor a kinoform, an element of infinite index, curves a flat image.
        sum += refracting_power(surface) / (surface.index_before * surface.index_after);
    }
    return sum == T(0) ? infinity<T>() : T(-1 / (lens.surfaces.back().index_after * sum));
}

/// The stop's image: its centre from `vertex_ray`, the ray from there with optical slope 1 as it stands at the vertex
/// next to the image, its size from that ray's optical slope there (Lagrange).
template <class T>
void set_pupil(const BasicParaxialRay<T>& vertex_ray, const T& index, const T& stop_diameter, T& z, T& diameter) {
    using std::abs;
    z = axis_crossing(vertex_ray);
    diameter = vertex_ray.slope == T(0) ? infinity<T>() : T(stop_diameter / abs(index * vertex_ray.slope));
}

}  // namespace paraxial_detail

template <class T>
BasicParaxialRay<T> trace_paraxial(const TraceLens<T>& lens, BasicParaxialRay<T> ray, int first, int last) {
    const int step = first <= last ? 1 : -1;
    for (int i = first;; i += step) {
        const TraceSurface<T>& surface = lens.surfaces[i];
        ray = step > 0 ? paraxial_detail::refracted(lens, ray, surface)
                       : paraxial_detail::refracted_backwards(lens, ray, surface);
        if (i == last) {
            return ray;
        }
        ray.height += ray.slope * (lens.surfaces[i + step].vertex_z - surface.vertex_z);
    }
}

template <class T>
BasicParaxialData<T> paraxial_data(const TraceLens<T>& lens) {
    using paraxial_detail::infinity;
    BasicParaxialData<T> data;
    paraxial_detail::set_cardinal_points(data, lens);
    data.petzval_radius = paraxial_detail::petzval_radius(lens);

    const int stop = paraxial_detail::find_stop(lens);
    const TraceSurface<T>& surface = lens.surfaces[stop];
    const T diameter = T(2) * paraxial_detail::stop_semi_diameter(lens);
    const int last = static_cast<int>(lens.surfaces.size()) - 1;
    paraxial_detail::set_pupil(paraxial_detail::ray_from_stop_to_front(lens), lens.surfaces.front().index_before,
                               diameter, data.entrance_pupil_z, data.entrance_pupil_diameter);
    paraxial_detail::set_pupil(trace_paraxial(lens, {T(0), T(1) / surface.index_before}, stop, last),
                               lens.surfaces.back().index_after, diameter, data.exit_pupil_z, data.exit_pupil_diameter);
    const bool is_afocal = data.efl == infinity<T>();
    data.f_number = is_afocal ? infinity<T>() : T(data.efl / data.entrance_pupil_diameter);
    return data;
}

template <class T>
T paraxial_image_distance(const TraceLens<T>& lens, const std::type_identity_t<T>& object_distance) {
    return paraxial_detail::axis_crossing(
        paraxial_detail::gaussian_constants(lens).through(paraxial_detail::ray_from_axis<T>(object_distance)));
}

template <class T>
BasicConjugates<T> paraxial_conjugates(const TraceLens<T>& lens, const std::type_identity_t<T>& object_distance) {
    using paraxial_detail::infinity;
    using std::abs;
    const paraxial_detail::GaussianConstants<T> constants = paraxial_detail::gaussian_constants(lens);
    const BasicParaxialRay<T> front = paraxial_detail::ray_from_axis<T>(object_distance);
    const BasicParaxialRay<T> rear = constants.through(front);
    BasicConjugates<T> conjugates;
    conjugates.image_distance = paraxial_detail::axis_crossing(rear);
    if (rear.slope != T(0)) {
        conjugates.magnification = constants.n_first * front.slope / (constants.n_last * rear.slope);
    } else {
        // An afocal lens magnifies objects at all distances alike.
        conjugates.magnification = front.slope == T(0) ? rear.height : infinity<T>();
    }
    if (const auto marginal = paraxial_marginal_ray(lens, object_distance)) {
        const T slope = abs(constants.through(*marginal).slope);
        conjugates.working_f_number = slope == T(0) ? infinity<T>() : T(1 / abs(2 * constants.n_last * slope));
        conjugates.object_numerical_aperture = constants.n_first * abs(marginal->slope);
    } else {
        conjugates.object_numerical_aperture = front.slope == T(0) ? T(0) : infinity<T>();
    }
    return conjugates;
}

template <class T>
std::optional<BasicParaxialRay<T>> paraxial_marginal_ray(const TraceLens<T>& lens,
                                                         const std::type_identity_t<T>& object_distance) {
    const BasicParaxialRay<T> any = paraxial_detail::ray_from_axis<T>(object_distance);
    const int stop = paraxial_detail::find_stop(lens);
    const T at_stop = trace_paraxial(lens, any, 0, stop).height;
    const T semi_diameter = paraxial_detail::stop_semi_diameter(lens);
    if (at_stop == T(0) || !(semi_diameter < paraxial_detail::infinity<T>())) {
        return std::nullopt;
    }
    const bool pupil_is_inverted = paraxial_detail::ray_from_stop_to_front(lens).slope < T(0);
    const T scale = (pupil_is_inverted ? -semi_diameter : semi_diameter) / at_stop;
    return BasicParaxialRay<T>{scale * any.height, scale * any.slope};
}

template <class T>
std::optional<BasicParaxialRay<T>> paraxial_chief_ray(const TraceLens<T>& lens,
                                                      const std::type_identity_t<T>& field_angle) {
    using std::abs;
    using std::tan;
    const BasicParaxialRay<T> any = paraxial_detail::ray_from_stop_to_front(lens);
    if (!(abs(field_angle) < T(std::numbers::pi / 2.0)) || any.slope == T(0)) {
        return std::nullopt;
    }
    const T slope = tan(field_angle);
    return BasicParaxialRay<T>{any.height * (slope / any.slope), slope};
}

template <class T>
std::optional<T> lagrange_invariant(const TraceLens<T>& lens, const std::type_identity_t<T>& field_angle) {
    const auto chief = paraxial_chief_ray(lens, field_angle);
    const auto marginal = paraxial_marginal_ray(lens, paraxial_detail::infinity<T>());
    if (!chief || !marginal) {
        return std::nullopt;
    }
    return T(lens.surfaces.front().index_before * marginal->height * chief->slope);
}

extern template BasicParaxialRay<double> trace_paraxial(const TraceLens<double>&, BasicParaxialRay<double>, int, int);
extern template BasicParaxialData<double> paraxial_data(const TraceLens<double>&);
extern template double paraxial_image_distance(const TraceLens<double>&, const double&);
extern template BasicConjugates<double> paraxial_conjugates(const TraceLens<double>&, const double&);

}  // namespace lensproof::optics
