// experiments/draw/section_geometry.h — what of a lens lies in its meridional section: curves, glass, barrels; in mm.
#pragma once
#include <array>
#include <string>
#include <vector>

#include "engine/optics/lens.h"

namespace lensproof::draw {

/// A point of the section x = 0 in lens space, mm.
struct SectionPoint {
    double z = 0.0;
    double y = 0.0;
};

using SectionLine = std::vector<SectionPoint>;

/// A surface's profile. Everything in it is finite.
struct SectionSurface {
    int number = 1;       // from 1, the stop included
    SectionLine curve;    // over the clear aperture, from its lower end to its upper one
    SectionPoint across;  // the unit vector along its own y, in which rims and stop blades lie
    double semi_diameter = 0.0;
    bool is_stop = false;
    bool is_mirror = false;
    bool is_glass = false;               // whether it bounds glass
    double ideal_focal_length_mm = 0.0;  // of an ideal lens there; 0: none
    bool is_phase = false;               // a grating or a kinoform
    bool is_exact = true;                // false: a stand-in, for the table's radius or aperture is no usable number
};

/// The glass between two surfaces.
struct SectionElement {
    int front = 1;        // number of its first surface
    SectionLine outline;  // closed
    std::string name;     // of the glass, or its n_d/V_d
    double n_d = 0.0;     // NaN where unknown
    double V_d = 0.0;     // NaN where unknown
};

struct SectionGeometry {
    std::vector<SectionSurface> surfaces;
    std::vector<SectionElement> elements;
    std::vector<std::array<SectionPoint, 2>> barrels;  // their upper halves
    double image_z = 0.0;
};

/// The section of `lens` with the rims and barrels that `prescription` states. A null `lens` (the table cannot be
/// traced) leaves the table: what is no number there is drawn as nothing worse than a flat of the neighbours' height.
///
/// A surface is drawn to its semi-diameter, or as far as it exists. An element's edge runs parallel to the axis at the
/// larger of its two semi-diameters (of its rim, where stated), the smaller surface being continued by a flat; where
/// these flats would meet, it runs straight from one surface's end to the other's.
SectionGeometry section_geometry(const optics::Prescription& prescription, const optics::Lens* lens);

}  // namespace lensproof::draw
