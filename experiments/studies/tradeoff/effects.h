// experiments/studies/tradeoff/effects.h — what each effect of lens and light contributes to one picture, from a pilot
// render and a few thousand rays.
#pragma once
#include <string>
#include <vector>

#include "experiments/studies/tradeoff/pilot.h"
#include "experiments/studies/tradeoff/smooth_light.h"
#include "experiments/studies/tradeoff/tolerance.h"

namespace lensproof::studies {

/// Something that a model may leave out.
struct Effect {
    std::string name;
    Contribution contribution;
    bool is_bound = false;       // the contribution is at most that
    std::string pass;            // of its own; empty: camera, wavelengths or paths make it
    double ns_per_sample = 0.0;  // of that pass
    std::string part_of;         // another effect that has it, too; else empty
    std::string no_pass;         // why this lens has none, though light goes astray in it; else empty
};

/// What the full model has and a lens without it has not: distortion, lateral-colour, aberration-blur, axial-colour,
/// defocus, vignetting, cos4, fresnel-loss, coating-colour, absorption, sensor. Each is done to the pilot's pictures,
/// or taken from them. Of the blur, what it is made of in third order: spherical-aberration, coma, astigmatism and
/// field-curvature, which wide fields and apertures exceed. Places, widths and light are the root mean square over the
/// probe's points, all beside a pinhole, whose pupil is that of first order: of chief rays, of what lies about them,
/// and of light. What a shift or a blur of so many of the scene's pixels does to colours depends on detail that the
/// pilot does not show: its error says so.
std::vector<Effect> lens_effects(const Pilot& pilot);

/// Light that goes astray: ghosts, faint-ghosts, barrel, diffraction. By a few samples of the first's and the third's
/// passes, from lamps beside the frame too: how much light it is, as an even veil over the picture; by `films` where
/// these few leave it open whether that is within the tolerance. Faint ghosts by the square of the ghosts, at the most;
/// diffraction by what leaves a pixel, and by the blur of its Airy core. Where there are no such passes, ghosts are
/// bounded by what pairs of surfaces reflect along the axis.
std::vector<Effect> stray_effects(const Pilot& pilot, const Tolerance& tolerance, KeptFilms& films);

/// What pictures are off by that differ in one thing and have the pilot's seeds: the exposure is that of all of the
/// picture.
Contribution difference(const Pilot& pilot, const std::vector<formats::Image>& without);

}  // namespace lensproof::studies
