// engine/render/film/film_image.h — the picture that a film's sums make.
#pragma once
#include "engine/formats/image/image.h"
#include "engine/render/film/picture.h"

namespace lensproof::render {

/// Channels: R, G, B (linear, 1 = saturation), their standard errors error.R, error.G, error.B (`PixelEstimate`), then
/// one spectral layer a wavelength: mean film irradiance over its band, W·m⁻²·nm⁻¹. A pixel without samples is black.
formats::Image film_image(const Picture& film);

/// R, G and B alone: for a preview.
formats::Image film_rgb(const Picture& film);

}  // namespace lensproof::render
