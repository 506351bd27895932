// engine/optics/focus.h — a lens stopped down and focused, as a photographer sets it.
#pragma once
#include "engine/optics/lens.h"
#include "engine/spectral/wavelengths.h"

namespace lensproof::optics {

/// The lens with its stop opened or closed to f-number `f_number` (paraxial: EFL over entrance pupil diameter, at
/// `wavelength_nm`, object at infinity). Throws InputError where that is wider than the prescription's stop.
Lens with_f_number(Lens lens, double f_number, double wavelength_nm = spectral::kLineD);

/// The lens focused, paraxially at `wavelength_nm`, on an object `object_distance_mm` in front of the table's first
/// vertex; infinity is allowed. Its focusing groups are driven to where the image is as far from the sensor as
/// infinity's is in the table; without such groups the sensor moves to the image. Throws InputError for an object that
/// the groups do not reach, or at or inside the front focal point, which has no real image.
Lens focused_at(Lens lens, double object_distance_mm, double wavelength_nm = spectral::kLineD);

}  // namespace lensproof::optics
