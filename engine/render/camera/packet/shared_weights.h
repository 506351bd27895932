// engine/render/camera/packet/shared_weights.h — what a camera path counts at each wavelength that it carries.
#pragma once
#include <array>
#include <cstddef>

#include "engine/base/select.h"
#include "engine/base/vec.h"

namespace lensproof::render {

/// What becomes of a path's ray outside, on its way into the camera, at one of the wavelengths.
template <class T>
struct FilmArrival {
    Vec2<T> at_px;    // on the film
    T transmittance;  // 0: it does not arrive
    T pdf;            // with which a path with this wavelength for its hero draws the ray; 0: never
};

template <class T, std::size_t wavelengths>
struct SharedWeights {
    std::array<T, wavelengths> weight;
    T shared_pdf;  // with which the ray is drawn by paths that carry these wavelengths
    T hero_pdf;    // and by the hero's alone
};

/// By the balance heuristic (SharedRays), in the pixel about `centre_px`; [0] is the hero, whose point lies in the
/// pixel, wherever rounding may see it.
///
/// T: double, or a packet of them; every lane has the bits of the double.
template <class T, std::size_t wavelengths>
constexpr SharedWeights<T, wavelengths> shared_weights(const std::array<FilmArrival<T>, wavelengths>& arrivals,
                                                       const Vec2<T>& centre_px) {
    const T fraction(1.0 / wavelengths);
    SharedWeights<T, wavelengths> shared{
        .weight = {arrivals[0].transmittance}, .shared_pdf = fraction * arrivals[0].pdf, .hero_pdf = arrivals[0].pdf};
    for (std::size_t i = 1; i < wavelengths; ++i) {
        const Vec2<T> off = arrivals[i].at_px - centre_px;
        const auto is_in_pixel = off.x >= T(-0.5) && off.x < T(0.5) && off.y >= T(-0.5) && off.y < T(0.5);
        shared.weight[i] = select(is_in_pixel, arrivals[i].transmittance, T(0));
        shared.shared_pdf = shared.shared_pdf + select(is_in_pixel, fraction * arrivals[i].pdf, T(0));
    }
    const auto is_drawn = shared.shared_pdf > T(0);
    const T per_pdf = select(is_drawn, T(1) / select(is_drawn, shared.shared_pdf, T(1)), T(0));
    for (T& weight : shared.weight) {
        weight = weight * per_pdf;
    }
    return shared;
}

}  // namespace lensproof::render
