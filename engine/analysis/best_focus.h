// engine/analysis/best_focus.h — where the image plane should stand, by the criterion that matters.
#pragma once
#include <span>

#include "engine/analysis/polychromatic_field.h"
#include "engine/optics/lens.h"

namespace lensproof::analysis {

/// What is best at best focus.
enum class FocusCriterion {
    paraxial,   // the paraxial image at the reference wavelength
    spot,       // least mean square distance of rays from their centroid, weighted by the beam's cross-section
    wavefront,  // least mean square path difference, in waves, tilt taken out
    mtf,        // highest mean of tangential and sagittal MTF at a frequency
};

/// A field and its weight in the decision.
struct WeightedField {
    PolychromaticField field;
    double weight = 1.0;
};

/// The answers are shifts of the image plane from where it stands, mm, positive away from the lens.

/// The paraxial image of an object `object_distance` mm in front of the first vertex. Throws InputError for an afocal
/// one.
double paraxial_focus_shift(const optics::Lens& lens, double reference_nm, double object_distance);

/// In closed form, since the mean square is a parabola in the shift: −Σ cov(position, slope) / Σ var(slope), in x and
/// y, over all fields; the centroid is that of all wavelengths. Throws InputError where no field has light.
double spot_focus_shift(std::span<const WeightedField> fields);

/// In closed form, since path differences to the feet of the perpendiculars are linear in the shift. Each wavelength's
/// tilt and piston are its own. Throws InputError where no field has light.
double wavefront_focus_shift(std::span<const WeightedField> fields);

/// Where the mean MTF at `frequency` (cycles per mm) is highest: the best of 65 places, within the depth over which
/// rays cross the chief ray and that of diffraction, refined by Brent's method. A field that is blurred over more
/// than 1.5 cycles at its spot's best focus counts with its geometric MTF. Throws InputError where no field has light,
/// or the frequency is not between 0 and the cutoff.
double mtf_focus_shift(std::span<const WeightedField> fields, double frequency);

/// The lens with its image plane moved by `shift`. Throws InputError where that is in front of its last vertex.
optics::Lens with_image_shift(optics::Lens lens, double shift);

}  // namespace lensproof::analysis
