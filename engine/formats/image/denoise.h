// engine/formats/image/denoise.h — noise that is guessed away, by Intel's Open Image Denoise where the program was
// built with it.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "engine/formats/image/image.h"

namespace lensproof::formats {

/// The library and its version; nothing where the program was built without.
std::optional<std::string> denoiser();

/// A picture without noise, as a trained network guesses it: no estimate any more, whose errors nobody knows. `rgb`: R,
/// G, B in linear light of any brightness. What guides it, where there is such: `albedo` in [0, 1] and `normal` in
/// [-1, 1], three numbers a pixel, rows from the top. `threads`: 0: one a core. Throws std::runtime_error where the
/// library fails, std::logic_error where there is none.
Image denoised(const Image& rgb, std::vector<float> albedo, std::vector<float> normal, int threads);

}  // namespace lensproof::formats
