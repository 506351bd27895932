// calibration/chromatic/mosaic.h — a plane of light from a raw Bayer mosaic.
#pragma once
#include <optional>
#include <string_view>
#include <vector>

#include "engine/formats/image/image.h"

namespace lensproof::calibration {

/// The colours of the top left 2 × 2 sites, row by row.
enum class MosaicPattern { rggb, bggr, grbg, gbrg };

/// "rggb", "bggr", "grbg" or "gbrg"; none for anything else.
std::optional<MosaicPattern> mosaic_pattern(std::string_view name);

/// One plane "Y" at full resolution from a mosaic under light of a narrow band, where the sites' colours differ by
/// nothing but a factor.
///
/// The strongest colour (by its mean) is taken as it is, and so are colours at least a quarter as strong, times the
/// ratio of the means; weaker ones are mostly noise, and their sites take the mean of the taken sites around them,
/// weighted by the inverse of the squared distance. That mean is symmetric about the site, so no edge or centroid
/// moves. Throws InputError for a picture of more than one channel or below 4 × 4 pixels, or without light.
formats::Image mosaic_plane(const formats::Image& raw, MosaicPattern pattern);

/// The same of the sites of one colour alone, whose others take the mean of its sites around them.
struct MosaicColour {
    char colour = 'g';  // 'r', 'g' or 'b'
    formats::Image plane;
};

/// The colours that `mosaic_plane` takes as they are, the strongest first. A filter that also passes light far from its
/// band makes them differ by more than a factor: each sees the lens's shift at the light that it sees.
std::vector<MosaicColour> mosaic_colours(const formats::Image& raw, MosaicPattern pattern);

}  // namespace lensproof::calibration
