// engine/render/stray/diffraction_settings.h — where diffraction at the stop begins.
#pragma once

namespace lensproof::render {

struct DiffractionSettings {
    /// Deflections on the film, in λN, from which light counts as diffracted; at least 1. The default is the radius of
    /// Airy's first dark ring (Born & Wolf, Principles of Optics, 7th ed., §8.5.2): the core of the image is left to
    /// the light that goes straight on. Rays know nothing of the rings' interference, so from about 5 on they carry the
    /// wave's light within 5 %, nearer by its mean alone.
    double smallest_airy = 1.22;
    /// Of the zone beside the edges in which rays that come anyway are diffracted, in units of the stop's
    /// semi-diameter: they stand for the light at the edge, so it is to be narrow.
    double zone_width = 0.02;
};

}  // namespace lensproof::render
