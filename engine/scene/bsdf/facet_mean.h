// engine/scene/bsdf/facet_mean.h — means over the facets of a rough surface that are seen from a direction.
#pragma once
#include <boost/math/quadrature/gauss.hpp>

#include "engine/scene/bsdf/ggx.h"

namespace lensproof::scene {

/// ∫₀¹ function, by kPoints of Gauss's.
template <int kPoints, class Function>
double integral_over_unit(const Function& function) {
    return boost::math::quadrature::gauss<double, kPoints>::integrate(function, 0.0, 1.0);
}

/// The mean of `function(m)` over what `ggx_visible_normal` draws for `wo`, to about 1e-4 of its variation.
template <class Function>
double visible_facet_mean(const Roughness& roughness, const Vec3d& wo, const Function& function) {
    constexpr int kAzimuths = 24;
    double sum = 0.0;
    for (int i = 0; i < kAzimuths; ++i) {
        const double u1 = (i + 0.5) / kAzimuths;
        sum += integral_over_unit<30>([&](double u2) { return function(ggx_visible_normal(roughness, wo, u1, u2)); });
    }
    return sum / kAzimuths;
}

}  // namespace lensproof::scene
