// engine/formats/prescription/prescription_losses.h — what plain tables of radii, thicknesses and indices cannot say of
// a prescription.
#pragma once
#include <optional>
#include <utility>
#include <vector>

#include "engine/optics/prescription.h"

namespace lensproof::formats {

/// Of a form that does not say something: a warning where rays then take other paths, else an info.
optics::Finding lost(const std::string& code, optics::Severity severity, int surface, const std::string& message);

/// The prescription at its first zoom position, if it has several; `lost_here` then says so.
optics::Prescription single_position(const optics::Prescription& prescription, std::vector<optics::Finding>& lost_here);

/// The clear semi-diameter of surface `index` (from 0) where nothing but one number can be said of it: the stated one,
/// or the rim where none is, narrowed by the barrel on either side. Nothing where nothing is stated.
std::optional<double> plain_semi_diameter(const optics::Prescription& prescription, std::size_t index);

/// For forms that hold no aperture and no fields: the clear apertures that those make, written into the rows that state
/// none and named. Throws InputError where the lens cannot be made, or where its apertures cannot be found.
void state_rims(optics::Prescription& prescription, std::vector<optics::Finding>& lost_here);

/// n_d and V_d of a medium's table of indices, as it is traced; V_d is 0 where the index does not fall from F to C.
std::pair<double, double> figures_of_table(const optics::StatedMedium& medium);

/// What neither the CSV table nor pbrt's says: toroids, tilts, coatings, blades, groups, surroundings, claims. Throws
/// InputError for a mirror or a thin element, without which the rest is no lens.
std::vector<optics::Finding> losses_of_tables(const optics::Prescription& prescription);

}  // namespace lensproof::formats
