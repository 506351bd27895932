// engine/render/raw/raw_image.h — a camera's raw values, and the picture that they develop into.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "engine/base/vec.h"
#include "engine/formats/image/image.h"

namespace lensproof::render {

/// How the two colours that a pixel behind a filter does not measure are found: OpenCV's means of the nearest pixels
/// that do, or the same with green along whichever of row and column varies less. Bilinear is linear in the light, as a
/// measurement of sharpness or place wants it.
enum class Demosaicing { bilinear, edge_aware };

/// Raw values as a camera stores them: pixel (x, y) covers the same square as the film's.
struct RawImage {
    formats::IntegerImage mosaic;  // one channel behind a filter pattern; without, one for each of the sensor's
    std::string pattern;           // "RGGB", …; empty: none
    int bits = 16;                 // values are below 2^bits
    int black_level = 0;           // the value without light
    int white_level = 0;           // the value at saturation
    Vec3d neutral{1.0, 1.0, 1.0};  // what white gives in R, G, B over the largest of them
    Demosaicing demosaicing = Demosaicing::bilinear;
};

/// The channel, 0 to 2 for R, G, B, that pixel (x, y) measures behind a pattern.
int mosaic_channel(const std::string& pattern, int x, int y);

/// Linear R, G, B (or Y), black at 0 and white light that saturates the most sensitive channel at 1 in each: black
/// level off, over the range, over the neutral. Noise below black stays, as negative values; where channels saturate,
/// those that are multiplied reach beyond 1. Pixels measured are unchanged by demosaicing; the borders are those of the
/// picture mirrored at its outermost pixels' centres.
formats::Image develop(const RawImage& raw);

/// Writes raw values and metadata as a 16-bit PNG. Whole or not at all.
void write_raw(const RawImage& raw, const std::filesystem::path& file);

}  // namespace lensproof::render
