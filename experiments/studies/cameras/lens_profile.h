// experiments/studies/cameras/lens_profile.h — what the lens's own rays say a measurement should find.
#pragma once
#include <array>

#include "calibration/profile/profile.h"
#include "engine/render/camera/camera.h"

namespace lensproof::studies {

/// Whose lateral colour a profile has by themselves, as that of spectral layers.
inline constexpr std::array<double, 4> kShownWavelengths_nm = {450.0, 500.0, 600.0, 650.0};

/// The profile that a perfect measurement of `camera`'s pictures would yield, from real chief rays and the real bundle
/// that passes every rim (nothing rendered, nothing fitted): the curves of `calibration/profile/profile.h`, with bands
/// of no width. The camera is an exact one.
///
/// Positions are those of object points at infinity in the plane the camera is focused for, weighted over wavelengths
/// as the channel sees the light (sensor response × illuminant); distortion and field angle are the green channel's.
/// Curves reach as far as chief rays do. Vignetting includes the Fresnel transmittance.
calibration::Profile lens_profile(const render::Camera& camera);

/// A lens before the sensor of the camera whose profile `like` is. Throws InputError where its pixel pitch is not
/// known.
render::CameraSettings camera_like(const calibration::Profile& like, const std::string& lens);

}  // namespace lensproof::studies
