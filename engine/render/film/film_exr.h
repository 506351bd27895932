// engine/render/film/film_exr.h — a film as a multi-part OpenEXR file, and back.
#pragma once
#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "engine/render/film/picture.h"
#include "engine/render/film/render_identity.h"
#include "engine/spectral/sensor_response.h"

namespace lensproof::render {

/// What a file says besides its pixels.
struct FilmNotes {
    RenderIdentity identity;                      // attributes "lensproof:identity:NAME"
    std::map<std::string, std::string> metadata;  // further attributes of the first part
    std::optional<spectral::RgbSpace> colours;  // of R, G, B: the attribute "chromaticities"; nothing: the sensor's own
    bool has_digest = false;                    // the attribute "lensproof:digest"
};

/// Writes the picture; whole or not at all, the same bytes for the same films and notes. Parts, each of 32-bit floats:
///
/// - rgb: R, G, B, linear, 1 = saturation. First, so that whoever takes the file for a picture gets it.
/// - spectral: one channel a layer, in the layout of spectral_exr.h: film irradiance, W·m⁻²·nm⁻¹.
/// - variance: variance.R, variance.G, variance.B, of the pixel's value (`PixelEstimate`).
/// - samples: how many camera paths each pixel has had, and in how many blocks; unsigned integers.
/// - features: Z (mm), albedo.R, …, normal.X, …, coverage (`Film::features`); where the film has them.
/// - light: R, G, B, variance.R, …, and spectral layers, what of all these came by light paths, whose number is the
///   attribute "lensproof:lightPaths"; where the film has them.
///
/// Of a picture that is the sum of several passes the first three are that sum's, and after them each pass has all of
/// these for itself, as "PASS.rgb", …; the attribute "lensproof:passes" names them.
///
/// The attribute "lensproof:leftOut" says how many samples were left out (`Film::left_out`), where any were, and
/// "lensproof:digest" is a digest of all pixels of all parts, where the notes ask for one.
void write_film_exr(const Picture& picture, const FilmNotes& notes, const std::filesystem::path& file);

/// Writes the picture alone as an EXR of one part: R, G and B as half floats, with the same notes, but no digest.
/// Returns how many numbers were beyond ±65504, the largest half, which stands in their place.
std::size_t write_half_exr(const Picture& picture, const FilmNotes& notes, const std::filesystem::path& file);

/// Films from their file, so that they add up: sums from means, variances and counts; of floats, so to 1e-7. Their
/// layout knows sizes and layers but no strata. Throws InputError naming the file where it is not one of the above, or
/// not what its digest says.
struct FilmFile {
    std::vector<PassFilm> films;
    FilmNotes notes;
};
FilmFile read_film_exr(const std::filesystem::path& file);

/// Only what such a file says besides its pixels.
FilmNotes read_film_notes(const std::filesystem::path& file);

}  // namespace lensproof::render
