// engine/formats/prescription/axial_terms.h — terms along a conic's normal, for forms that know those along the axis.
#pragma once
#include <optional>

#include "engine/formats/prescription/remarks.h"
#include "engine/optics/prescription.h"

namespace lensproof::formats {

/// Powers of r in the place of others, and how well they do.
struct AxialTerms {
    optics::AsphereTerms terms{};
    double reach_mm = 0.0;
    double error_mm = 0.0;  // the largest of the sag within the reach
};

/// The surface's even terms as terms along the axis. That of r² is kept, since first order sees it; those to r²⁰ meet
/// the sag at nine radii up to the semi-diameter, or to half the radius of curvature where none is known.
AxialTerms axial_terms(const optics::PrescribedSurface& row, std::optional<double> semi_diameter_mm);

/// Puts them in the place of terms along the normal, and adds to `lost` what that costs: a warning above a nanometre.
void state_along_axis(optics::Prescription& prescription, std::vector<optics::Finding>& lost);

}  // namespace lensproof::formats
