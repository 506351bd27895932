// engine/optics/projection.h — the mappings from field angle to image height that lenses are designed for.
#pragma once
#include <array>
#include <cmath>
#include <cstddef>

namespace lensproof::optics {

/// r = f g(θ), g(θ) = tan θ, θ, 2 sin(θ/2) (equal solid angles have equal areas), 2 tan(θ/2) (circles stay circles) or
/// sin θ (an even sky gives an even picture).
enum class Projection { rectilinear, equidistant, equisolid, stereographic, orthographic };

inline constexpr std::array kProjections = {Projection::rectilinear, Projection::equidistant, Projection::equisolid,
                                            Projection::stereographic, Projection::orthographic};

/// "rectilinear", …
constexpr const char* projection_name(Projection projection) {
    constexpr std::array kNames = {"rectilinear", "equidistant", "equisolid", "stereographic", "orthographic"};
    return kNames[static_cast<std::size_t>(projection)];
}

/// "f tan θ", …
constexpr const char* projection_formula(Projection projection) {
    constexpr std::array kFormulas = {"f tan θ", "f θ", "2 f sin(θ/2)", "2 f tan(θ/2)", "f sin θ"};
    return kFormulas[static_cast<std::size_t>(projection)];
}

/// g(θ) = r / f at a field angle in radians. T: double or ceres::Jet.
template <class T>
T projected_radius(Projection projection, const T& field_angle) {
    using std::sin;
    using std::tan;
    switch (projection) {
        case Projection::rectilinear:
            return tan(field_angle);
        case Projection::equidistant:
            break;
        case Projection::equisolid:
            return T(2) * sin(T(0.5) * field_angle);
        case Projection::stereographic:
            return T(2) * tan(T(0.5) * field_angle);
        case Projection::orthographic:
            return sin(field_angle);
    }
    return field_angle;
}

/// The field angle (rad) of g = r / f ≥ 0; more than π for a g that the projection does not reach.
inline double projected_angle(Projection projection, double g) {
    switch (projection) {
        case Projection::rectilinear:
            return std::atan(g);
        case Projection::equidistant:
            break;
        case Projection::equisolid:
            return g <= 2.0 ? 2.0 * std::asin(0.5 * g) : 2.0 * g;
        case Projection::stereographic:
            return 2.0 * std::atan(0.5 * g);
        case Projection::orthographic:
            return g <= 1.0 ? std::asin(g) : 4.0 * g;
    }
    return g;
}

}  // namespace lensproof::optics
