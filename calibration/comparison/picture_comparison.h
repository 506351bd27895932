// calibration/comparison/picture_comparison.h — two pictures registered, matched in exposure, and compared.
#pragma once
#include <map>
#include <optional>
#include <string>

#include "calibration/comparison/denoised_difference.h"
#include "calibration/comparison/exposure_match.h"
#include "calibration/comparison/flip.h"
#include "calibration/comparison/overlap.h"
#include "calibration/comparison/registration.h"
#include "calibration/statistics/curve.h"
#include "engine/formats/image/image.h"

namespace lensproof::calibration {

struct ComparisonWishes {
    bool registers = true;
    std::optional<WarpModel> model;  // none: chosen
    bool matches_exposure = true;
    ClippedFrom clipped;
    bool is_high_range = false;  // both pictures: FLIP looks at several exposures
    double pixels_per_degree = kFlipPixelsPerDegree;
    bool makes_maps = false;
    int threads = 0;
};

/// What is to be told of two pictures. `b` has been brought to `a`'s places and exposure before.
struct PictureComparison {
    Registration registration;
    ExposureMatch exposure;
    Estimate rms;      // of the displayed values (sRGB, 0 to 1)
    Estimate psnr_db;  // of the same; infinite where they are equal
    Estimate ssim;     // of the same; NaN in pictures below 11 px a side
    Estimate flip;     // the mean
    std::optional<FlipExposures> flip_exposures;
    Estimate ciede2000_mean;
    Estimate ciede2000_p99;               // the 99th percentile over pixels
    std::map<std::string, Curve> curves;  // radial_differences
    // Where maps were asked for: `b` over `a`, as everything was told of it, and the maps.
    std::optional<formats::Image> b_over_a;
    std::optional<DenoisedDifference> difference;
    std::optional<formats::Image> flip_map;
    std::optional<formats::Image> ciede2000_map;
};

/// Compares pictures alike (`is_shown`, of one size, finite) in linear light. Where the registration found them unlike,
/// nothing else is filled in.
PictureComparison compare_pictures(const formats::Image& a, formats::Image b, const ComparisonWishes& wishes);

}  // namespace lensproof::calibration
