// engine/formats/prescription/surface_chain.h — from local coordinates, surface after surface, to a table along one
// axis.
#pragma once
#include <vector>

#include "engine/optics/frame.h"
#include "engine/optics/prescription.h"

namespace lensproof::formats {

/// A surface as design programs place it: in a frame that has come about by the thicknesses, shifts and tilts before
/// it.
struct ChainLink {
    optics::Frame frame;
    double thickness_mm = 0.0;  // as stated behind it
    bool straight = true;       // nothing but that thickness lies between it and the next link
};

/// Takes folds out: what follows a flat mirror that is tilted against the axis is turned over at it, and continues the
/// axis straight on, with the signs of all that follows turned where light then runs the other way. The mirror itself
/// becomes a flat dummy across the axis, without a rim of its own unless it is the stop. Returns the rows (from 0)
/// where a mirror was. Other mirrors stay.
std::vector<int> unfold(std::vector<optics::PrescribedSurface>& rows, std::vector<ChainLink>& links);

/// Writes the links' places into `rows`: thickness as the distance of vertices along the axis, decentre and tilt. The
/// last link is the image's, which has no row. Where there is nothing but a thickness between two aligned surfaces, it
/// is taken as stated, digit for digit; shifts and tilts below 1e-12 mm and 1e-12° are what rounding leaves of breaks
/// that undo each other, and dropped.
void place_rows(std::vector<optics::PrescribedSurface>& rows, const std::vector<ChainLink>& links);

/// Of a frame that stands at rest, but for rounding: no tilt, whatever its decentre.
bool is_upright(const optics::Frame& frame);

}  // namespace lensproof::formats
