// engine/optics/packet/coated_lanes.h — what a coated surface reflects and lets through, for the lanes of a packet.
#pragma once
#include "engine/optics/coating.h"
#include "engine/optics/packet/media.h"
#include "engine/optics/packet/spectral_lens.h"

namespace lensproof::optics {

enum class CoatedPower { reflected, transmitted };

/// One of a coating's powers, of unpolarised light that meets the surface as `media` says, with the bits of a single
/// ray's; nothing of lanes outside `lanes`. `of_lane(lane)`: the same of one of them, for coatings that absorb, and
/// lanes in which a wave fades or all is reflected.
template <class Numbers, class Scalar, bool per_lane, class OfLane>
Numbers coated_power(CoatedPower power, const SurfaceCoatings<Scalar>& coatings, bool is_forward,
                     const Media<Numbers>& media, const ByWavelength<Numbers, per_lane>& by_wavelength,
                     const Numbers& cos_incidence, MaskOf<Numbers> lanes, const OfLane& of_lane) {
    const Numbers one(Scalar(1));
    const Numbers zero(Scalar(0));
    const bool is_reflected = power == CoatedPower::reflected;
    if (coatings.stated != nullptr) {
        const Numbers stated = by_wavelength.number(coatings.stated);
        if (coatings.is_mirror) {
            return is_reflected ? zero : stated;
        }
        const auto is_beyond = is_beyond_critical(media.before, media.after, cos_incidence, true);
        const Numbers reflected = select(is_beyond, one, stated);
        return is_reflected ? reflected : one - reflected;
    }
    Numbers found = zero;
    if (coatings.clear_layer_count > 0) {
        const auto layer_at = [&](int i) {
            const int layer = is_forward ? coatings.clear_layer_count - 1 - i : i;
            const auto [index, phase_by_q, squared, per_squared] =
                by_wavelength.row(coatings.clear_layers + layer * coatings.wavelengths);
            return ClearLayer<Numbers>{index, phase_by_q, squared, per_squared};
        };
        const Numbers per_squared_before = by_wavelength.number(coatings.per_squared_before);
        const Numbers per_squared_after = by_wavelength.number(coatings.per_squared_after);
        const ClearFields<Numbers> clear = clear_coating_fields(
            coatings.clear_layer_count, layer_at,
            CoatedMedia<Numbers>{.near = media.before,
                                 .far = media.after,
                                 .per_squared_near = is_forward ? per_squared_before : per_squared_after,
                                 .per_squared_far = is_forward ? per_squared_after : per_squared_before},
            cos_incidence);
        found = is_reflected ? clear.fields.reflectance() : clear.fields.transmittance();
        lanes = lanes && !clear.holds;
    }
    return Numbers::by_lane(lanes, found, of_lane);
}

}  // namespace lensproof::optics
