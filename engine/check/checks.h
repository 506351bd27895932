// engine/check/checks.h — the checks, by what they look at. Each appends what it finds; the rules' numbers refer to the
// list in engine/check/README.md.
#pragma once
#include "engine/check/checked_lens.h"

namespace lensproof::check {

using enum optics::Severity;

/// Row by row: numbers, stop, thicknesses, semi-diameters.
void check_table(const CheckedLens& checked, Findings& findings);

/// Surfaces against each other: edges, centres, crossings, cement, aspheres.
void check_geometry(const CheckedLens& checked, Findings& findings);

/// Whether a finding of check_geometry is one that only settings.manufacture brings about.
bool is_custom_of_manufacture(const optics::Finding& finding);

/// Glasses: names, indices, dispersion, ranges.
void check_glasses(const CheckedLens& checked, Findings& findings);

/// First-order data against what is claimed.
void check_first_order(const CheckedLens& checked, Findings& findings);

/// Whether the list is reversed, is in other units, or holds diameters.
void check_conventions(const CheckedLens& checked, Findings& findings);

/// Real rays of the axial beam.
void check_axial_rays(const CheckedLens& checked, Findings& findings);

/// Real rays at the claimed field.
void check_field_rays(const CheckedLens& checked, Findings& findings);

/// Which change of one number would restore the claims.
void suggest_changes(const CheckedLens& checked, Findings& findings);

}  // namespace lensproof::check
