// experiments/draw/lens_section.h — the drawing of a lens: its section, rays at three fields, and what was found.
#pragma once
#include <string>
#include <vector>

#include "engine/optics/lens.h"

namespace lensproof::draw {

struct LensSectionOptions {
    double width_px = 1100.0;
    double largest_height_px = 560.0;  // of the section itself
    int rays = 5;                      // of a bundle, the chief ray among them; at least 3
    std::size_t most_findings = 6;     // that are written out below the section
    std::vector<double> fields_deg{};  // empty: the axis, 0.7 and all of the field that is stated or passes
};

/// An SVG file with the section x = 0 of a lens, to one scale along and across the axis: glasses tinted (crowns blue,
/// flints ochre, stronger with the index) and named, the stop, rims and barrels as stated, the sensor, and bundles of
/// rays that really pass, at some fields. Surfaces with an error among `findings` are red, with a warning orange, and
/// carry its code; below stand the findings themselves, errors first.
///
/// `lens`: made from `prescription`, or null where it could not be made; then what the table gives is drawn, and that
/// no ray could be traced is said. Any text in it is shown as text. The same arguments give the same bytes. Throws
/// nothing but std::bad_alloc, whatever the table holds.
std::string lens_section_svg(const optics::Prescription& prescription, const optics::Lens* lens,
                             const std::vector<optics::Finding>& findings, const LensSectionOptions& options = {});

}  // namespace lensproof::draw
