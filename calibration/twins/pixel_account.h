// calibration/twins/pixel_account.h — why a photo's pixels differ from its twin's: light, place, sharpness or noise.
#pragma once
#include <vector>

#include "calibration/twins/point_account.h"
#include "engine/formats/image/image.h"

namespace lensproof::calibration {

/// Root mean squares over the pixels among the chart's points, in fractions of the chart's contrast in the photo. One
/// thing after the other is taken into account, and what it lowers is its part: light, place, sharpness; of what is
/// left noise explains a part.
///
///   light      an offset, and a factor that varies over the frame by a polynomial of second degree: vignetting, uneven
///              light, the ink's black, haze
///   place      the twin moved to where its points are in the photo, by a polynomial of third degree
///   sharpness  the best mixture of the twin with itself blurred by 1 and 2 px: blurring and sharpening alike
struct PixelAccount {
    int pixels = 0;
    double as_rendered = 0.0;  // after one factor of exposure
    double light = 0.0;
    double place = 0.0;
    double sharpness = 0.0;
    double noise = 0.0;  // of photo and twin, as measured in each
    double unexplained = 0.0;
};

/// A photo and its twin, linear light; of one size.
struct PhotoAndTwin {
    const formats::Image& photo;
    const formats::Image& twin;
    int photo_channel = 0;  // those to be compared
    int twin_channel = 0;
    double contrast = 1.0;     // of the chart in the photo: white less black
    double photo_noise = 0.0;  // standard deviation of a pixel
    double twin_noise = 0.0;
};

/// The points are of this photo alone; at least four, not on a line.
PixelAccount account_of_pixels(const PhotoAndTwin& pictures, const std::vector<TwinPoint>& points);

/// Photo less twin, of the channels to be compared, in fractions of the contrast; NaN but among the points.
formats::Image difference_among(const PhotoAndTwin& pictures, const std::vector<TwinPoint>& points);

/// The twin in the photo's exposure: each of the photo's channels by a factor and an offset, over the pixels among the
/// points. A twin without that channel lends its first.
formats::Image in_light_of(const formats::Image& twin, const formats::Image& photo,
                           const std::vector<TwinPoint>& points);

void fields(JsonArchive& json, PixelAccount& account);

}  // namespace lensproof::calibration
