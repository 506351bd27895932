// engine/analysis/seidel.h — third-order aberrations: Seidel's sums and the colour sums, surface by surface.
#pragma once
#include <limits>
#include <optional>
#include <vector>

#include "engine/optics/paraxial.h"
#include "engine/optics/surface_axes.h"

namespace lensproof::analysis {

/// What one surface adds to the sums, or their total; mm. Welford, Aberrations of Optical Systems (1986), ch. 8 and
/// 10; signs as in rayoptics, so that S1 > 0 is undercorrected spherical aberration.
template <class T>
struct SeidelTerms {
    T s1 = T(0);  // spherical aberration
    T s2 = T(0);  // coma
    T s3 = T(0);  // astigmatism
    T s4 = T(0);  // Petzval's curvature
    T s5 = T(0);  // distortion
    T c1 = T(0);  // axial colour
    T c2 = T(0);  // lateral colour

    SeidelTerms& operator+=(const SeidelTerms& other) {
        s1 += other.s1;
        s2 += other.s2;
        s3 += other.s3;
        s4 += other.s4;
        s5 += other.s5;
        c1 += other.c1;
        c2 += other.c2;
        return *this;
    }
};

template <class T>
struct SeidelSums {
    std::vector<SeidelTerms<T>> surfaces;  // as in the prescription; a plane within one medium, as the stop, has 0
    SeidelTerms<T> total;
    T image_slope = T(0);  // n' u' of the marginal ray behind the lens
};

/// The lens at three wavelengths: the sums S at `reference`, the colour sums for the change of index from
/// `long_wavelength` to `short_wavelength` (F − C by custom), which have the same surfaces. For the full stop, the
/// field `field_angle` at the entrance pupil and an object `object_distance` mm in front of the first vertex.
///
/// With A = n (u + y c), Ā = n (ū + ȳ c), H = A ȳ − Ā y and Δ the change at a surface,
///     S1 = −A² y Δ(u/n),  S2 = −A Ā y Δ(u/n),  S3 = −Ā² y Δ(u/n),  S4 = −H² c Δ(1/n),
///     S5 = −Ā³ y Δ(1/n²) + Ā ȳ (Ā y − H) c Δ(1/n),  C1 = A y Δ(δn/n),  C2 = Ā y Δ(δn/n),
/// in which nothing is divided by A or y, and
///     Δ(u/n) = A Δ(1/n²) − y c Δ(1/n),  Δ(1/n) = −(n' − n) / (n n'),
/// so that a small step of index keeps its digits and none gives exactly 0. A surface whose sag is that of the sphere
/// of its vertex curvature plus G r⁴ + O(r⁶) adds 8 G Δn (y⁴, y³ ȳ, y² ȳ², 0, y ȳ³). A toroid counts as its profile in
/// y–z turned about the axis; tilts and decentres are left out, and so are odd aspheric terms: r³ is of no third order.
/// An ideal lens adds nothing. Nothing is known of a lens with kinoforms.
///
/// The theory takes the field by its tangent, which grows without bound: for a fisheye the sums say little long before
/// 90°. Nothing where there is no paraxial chief or marginal ray (paraxial.h): at and beyond 90°, with the entrance
/// pupil at infinity, with the object's image in the stop, and for a stop without a semi-diameter.
template <class T>
std::optional<SeidelSums<T>> seidel_sums(
    const optics::TraceLens<T>& reference, const optics::TraceLens<T>& short_wavelength,
    const optics::TraceLens<T>& long_wavelength, const std::type_identity_t<T>& field_angle,
    const std::type_identity_t<T>& object_distance = std::numeric_limits<T>::infinity());

// ---------------------------------------------------------------------------------------------------------------------

namespace seidel_detail {

/// 8 G, where the sag departs from the sphere of the vertex's curvature by G r⁴. With the curvature c that the shape
/// states and its r² term a, the vertex has c + 2 a, and 8 G = (1 + k) c³ − (c + 2 a)³ + 8 A4; along the conic's normal
/// a r² counts 1 + c² r² / 2 times.
template <class T>
T departure_from_sphere(const optics::TraceLens<T>& lens, const optics::TraceSurface<T>& surface) {
    const optics::SurfaceShape<T> shape = optics::shape_of(lens, surface);
    const T& c = shape.curvature;
    const T& c_vertex = surface.curvature;
    const T r2_term = 2 * shape.asphere[0];
    const T r4_term = shape.along_normal ? shape.asphere[1] + shape.asphere[0] * c * c / 2 : shape.asphere[1];
    return shape.conic * c * c * c - r2_term * (c * c + c * c_vertex + c_vertex * c_vertex) + 8 * r4_term;
}

/// δn / n of one medium.
template <class T>
T dispersion(const T& index, const T& short_index, const T& long_index) {
    return (short_index - long_index) / index;
}

template <class T>
SeidelTerms<T> surface_terms(const optics::TraceSurface<T>& surface, const T& departure,
                             const optics::BasicParaxialRay<T>& marginal, const optics::BasicParaxialRay<T>& chief) {
    const T& n = surface.index_before;
    const T& n_after = surface.index_after;
    const T& c = surface.curvature;
    const T& y = marginal.height;
    const T& y_chief = chief.height;
    const T a = n * (marginal.slope + y * c);
    const T a_chief = n * (chief.slope + y_chief * c);
    const T invariant = a * y_chief - a_chief * y;
    const T step = n_after - n;
    const T change_1 = -step / (n * n_after);                   // Δ(1/n)
    const T change_2 = change_1 * (T(1) / n + T(1) / n_after);  // Δ(1/n²)
    const T bend = a * change_2 - y * c * change_1;             // Δ(u/n)
    const T figure = departure * step * y;
    return {.s1 = -a * a * y * bend + figure * y * y * y,
            .s2 = -a * a_chief * y * bend + figure * y * y * y_chief,
            .s3 = -a_chief * a_chief * y * bend + figure * y * y_chief * y_chief,
            .s4 = -invariant * invariant * c * change_1,
            .s5 = a_chief * (y_chief * (a_chief * y - invariant) * c * change_1 - a_chief * a_chief * y * change_2) +
                  figure * y_chief * y_chief * y_chief,
            .c1 = a * y,
            .c2 = a_chief * y};
}

}  // namespace seidel_detail

template <class T>
std::optional<SeidelSums<T>> seidel_sums(const optics::TraceLens<T>& reference,
                                         const optics::TraceLens<T>& short_wavelength,
                                         const optics::TraceLens<T>& long_wavelength,
                                         const std::type_identity_t<T>& field_angle,
                                         const std::type_identity_t<T>& object_distance) {
    auto marginal = optics::paraxial_marginal_ray(reference, object_distance);
    auto chief = optics::paraxial_chief_ray(reference, field_angle);
    const bool has_kinoforms = std::ranges::any_of(reference.specials, [](const optics::SpecialSurface<T>& special) {
        return special.thin.kind == optics::ThinKind::phase;
    });
    if (!marginal || !chief || has_kinoforms) {
        return std::nullopt;
    }
    SeidelSums<T> sums;
    for (int i = 0; i < static_cast<int>(reference.surfaces.size()); ++i) {
        const optics::TraceSurface<T>& surface = reference.surfaces[i];
        if (i > 0) {
            const T gap = surface.vertex_z - reference.surfaces[i - 1].vertex_z;
            marginal->height += gap * marginal->slope;
            chief->height += gap * chief->slope;
        }
        SeidelTerms<T> terms;
        if (optics::paraxial_detail::thin_power(reference, surface) == T(0)) {
            terms = seidel_detail::surface_terms(surface, seidel_detail::departure_from_sphere(reference, surface),
                                                 *marginal, *chief);
        }
        const optics::TraceSurface<T>& at_short = short_wavelength.surfaces[i];
        const optics::TraceSurface<T>& at_long = long_wavelength.surfaces[i];
        const T change = seidel_detail::dispersion(surface.index_after, at_short.index_after, at_long.index_after) -
                         seidel_detail::dispersion(surface.index_before, at_short.index_before, at_long.index_before);
        terms.c1 *= change;
        terms.c2 *= change;
        sums.total += terms;
        sums.surfaces.push_back(terms);
        marginal = optics::trace_paraxial(reference, *marginal, i, i);
        chief = optics::trace_paraxial(reference, *chief, i, i);
    }
    sums.image_slope = reference.surfaces.back().index_after * marginal->slope;
    return sums;
}

extern template std::optional<SeidelSums<double>> seidel_sums(const optics::TraceLens<double>&,
                                                              const optics::TraceLens<double>&,
                                                              const optics::TraceLens<double>&, const double&,
                                                              const double&);

}  // namespace lensproof::analysis
