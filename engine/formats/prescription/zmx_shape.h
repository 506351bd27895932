// engine/formats/prescription/zmx_shape.h — what the parameters of a Zemax surface mean.
#pragma once
#include "engine/formats/prescription/remarks.h"
#include "engine/formats/prescription/zmx_file.h"
#include "engine/optics/prescription.h"

namespace lensproof::formats {

/// Adds to a row, which has its radius and its conic, the shape beyond those of surface `number` of a file whose
/// lengths are of `unit_mm`. A type that is not known and terms that have no place are errors among the remarks, of the
/// code "surface-type"; the row is then without them.
void read_zmx_shape(optics::PrescribedSurface& row, const ZmxSurface& surface, int number, double unit_mm,
                    Remarks& remarks);

}  // namespace lensproof::formats
