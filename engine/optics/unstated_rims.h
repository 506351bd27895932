// engine/optics/unstated_rims.h — the openings that a prescription does not state, from what it is designed for.
#pragma once
#include "engine/optics/lens.h"

namespace lensproof::optics {

/// Opens the stop as the governing aperture says, paraxially at the reference wavelength; a stop that has a
/// semi-diameter of its own opens no further. Throws InputError for an aperture that says nothing of this lens.
void open_stop(Lens& lens, const Prescription& prescription);

/// Makes the rims of surfaces that have none (infinite ones) just so wide that the stated fields' light fills the stop,
/// as design programs do: real rays along the bundle's two diameters, to the pupil that vignetting factors leave. The
/// fields are those of the design, or the half field or the image circle that the source claims; without any, the axis.
/// In lenses with tilted or shifted surfaces, and where no chief ray passes, paraxial marginal and chief rays are added
/// up. Where the stop alone has no size it opens as far as the others let an axial beam pass, which is among the lens's
/// findings. Throws InputError where the stop's opening is not known.
void estimate_rims(Lens& lens, const Prescription& prescription);

}  // namespace lensproof::optics
