// engine/render/camera/gaussian_optics.h — optics without aberrations: pinhole, thin lens, and a lens's own first
// order.
#pragma once
#include "engine/optics/lens.h"
#include "engine/render/camera/camera_settings.h"

namespace lensproof::render {

/// First-order optics between film and scene at one wavelength; lens space, mm. A film ray crosses the pupil's plane
/// (z = `pupil_z`, behind the lens) at height h with slope s = dh/dz; in front of the lens it is the line that crosses
/// z = `object_z` at height h_h h + h_s s with slope s_h h + s_s s, in x and y alike.
struct GaussianOptics {
    double film_z = 0.0;
    double pupil_z = 0.0;
    double pupil_radius_mm = 0.0;
    bool is_pinhole = false;  // paths cross the pupil's centre, and count for all of it
    double object_z = 0.0;
    double h_h = 1.0;
    double h_s = 0.0;
    double s_h = 0.0;
    double s_s = 1.0;
    double transmittance = 1.0;

    friend bool operator==(const GaussianOptics&, const GaussianOptics&) = default;
};

/// Of a ray along a lens's axis; 1 where it does not come through (a stop with a central obstruction).
double axial_transmittance(const optics::Lens& lens, double wavelength_nm);

/// `lens`, stopped down and focused, as one of the ideal models at a wavelength. Throws InputError for a lens that has
/// no focal length, and for a paraxial one whose exit pupil lies at infinity.
GaussianOptics gaussian_optics(const optics::Lens& lens, LensModel model, double wavelength_nm);

/// A pinhole or a thin lens that stands for no lens: of focal length and f-number, focused `focus_distance_mm` before
/// it, at the frame's origin; it loses no light. Throws InputError for another model and for a focus within the focal
/// length.
GaussianOptics gaussian_optics(double focal_length_mm, double f_number, double focus_distance_mm, LensModel model);

}  // namespace lensproof::render
