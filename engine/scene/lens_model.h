// engine/scene/lens_model.h — what stands for the lens of a camera.
#pragma once
#include <string>
#include <vector>

namespace lensproof::scene {

/// All are made from a lens and its settings, expose alike, and so can be compared:
///
///   exact       the lens itself, surface by surface
///   paraxial    its Gaussian optics at each wavelength: pupils, principal planes, axial and lateral colour of first
///               order; no other aberration, no rims but the stop
///   thin-lens   focal length and entrance pupil of the reference line, at the front principal plane
///   pinhole     the thin lens's centre alone, with the light of its whole opening: no blur
///
/// The last three pass what the lens passes along its axis.
enum class LensModel { exact, paraxial, thin_lens, pinhole };

/// "exact", "paraxial", "thin-lens", "pinhole".
std::vector<std::string> lens_model_names();
/// Throws InputError for another name.
LensModel lens_model_named(const std::string& name);
std::string name_of(LensModel model);

}  // namespace lensproof::scene
