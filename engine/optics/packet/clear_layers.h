// engine/optics/packet/clear_layers.h — a coating's layers for the lanes of a packet.
#pragma once
#include "engine/optics/coating.h"
#include "engine/optics/packet/trace_kernels.h"

namespace lensproof::optics {

/// Of a surface's clear coating the i-th layer from the far side of light that comes from the scene or, if not
/// `from_scene_side`, from the sensor. `look_up`: of a table by wavelength for the lanes.
template <class Scalar, class LookUp>
auto clear_layer_at(const KernelLens<Scalar>& lens, const typename SpectralLens<Scalar>::Indices& of,
                    bool from_scene_side, const LookUp& look_up) {
    return [&, from_scene_side](int i) {
        const int layer = from_scene_side ? of.clear_layer_count - 1 - i : i;
        const Scalar* tables = of.clear_layers + 2 * layer * lens.wavelengths;
        using Numbers = decltype(look_up(tables));
        return TraceLayer<Numbers>{
            .index = look_up(tables), .thickness = look_up(tables + lens.wavelengths), .extinction = Numbers()};
    };
}

}  // namespace lensproof::optics
