// experiments/studies/tradeoff/effect_kinds.h — what an effect makes of a picture: a gain, a shift, a blur, more light.
#pragma once
#include <array>
#include <functional>
#include <string>
#include <vector>

#include "experiments/studies/tradeoff/effects.h"
#include "experiments/studies/tradeoff/pilot_changes.h"

namespace lensproof::studies {

/// The root of the mean square of values over a frame.
Measured rms(const std::vector<double>& values);
/// Of a number of the pilot's pixels.
Measured rms_over_pixels(const Pilot& pilot, const std::function<double(int x, int y)>& of);

/// One constant gain for all of the picture.
Effect gain_effect(const Pilot& pilot, const std::string& name, const Vec3d& gain);

/// Brightness over the frame that falls as `light` says, 1 on the axis, `ev` rms: without it the picture would be
/// brighter.
Effect falloff_effect(const Pilot& pilot, const std::string& name, const RadialMean& light, const Measured& ev);

/// Radial shifts of R, G and B, in the scene's pixels, `px` rms.
Effect shift_effect(const Pilot& pilot, const std::string& name, const std::array<RadialMean, 3>& shift_px,
                    const Measured& px);

/// How a blur of that rms radius, in the scene's pixels, is seen, `px` rms.
Effect blur_effect(const Pilot& pilot, const std::string& name, const PixelSpread& spread_px, const Measured& px);

/// Light as an even veil, a fraction of the picture's mean: what is more of it may be seen by so much, with its
/// own error.
Contribution veil_contribution(const Pilot& pilot, const Measured& fraction);

}  // namespace lensproof::studies
