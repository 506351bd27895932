// engine/render/stray/entry.h — light that enters a camera and what becomes of it there, drawn at random as a whole.
#pragma once
#include <algorithm>
#include <array>

#include "engine/base/vec.h"
#include "engine/spectral/spectral_sample.h"

namespace lensproof::render {

/// What light of an origin does in a camera is the question that an entrance answers, a class in this folder each:
///
///   draw    a ray into the camera for light of an origin (world), and all that is left to chance behind the front
///   meet    the same for a ray (world) that comes anyway; its direction and end are that ray's; nothing where it does
///           not meet the front
///
/// Estimates are unbiased at every wavelength of a path, whichever of them is its hero, or, once it went on alone, at
/// that.
struct Entry {
    Vec3d direction;  // world, of unit length, into the camera
    Vec3d end;        // world: the light arrives if nothing stands between its origin and this
    std::array<Vec2d, spectral::kWavelengthsPerPath> at_px;  // where it lands on the film, a wavelength each
    /// What is left of it over the pdf of what the wavelength drew by itself. 0: it does not arrive.
    std::array<double, spectral::kWavelengthsPerPath> weight{};
    /// Dust on the front scattered it, before anything else in the camera did.
    std::array<bool, spectral::kWavelengthsPerPath> is_by_dust{};
    /// Of what they all drew: per solid angle at the origin, of far light per mm² across it; of a ray that comes anyway
    /// no more than the probability of what was left to chance.
    double pdf = 1.0;

    [[nodiscard]] bool is_dark() const {
        return std::ranges::none_of(weight, [](double value) { return value > 0.0; });
    }
};

}  // namespace lensproof::render
