// calibration/detection/working_copy.h — OpenCV's views of a picture.
#pragma once
#include <opencv2/core.hpp>

#include "engine/base/vec.h"
#include "engine/formats/image/image.h"

namespace lensproof::calibration {

/// One channel in linear light as CV_32F. What is not finite becomes 0.
cv::Mat channel_plane(const formats::Image& image, int channel);

/// The light of a plane (CV_32F) between its pixels, bilinear; 0 outside the picture.
double light_at(const cv::Mat& plane, const Vec2d& p);

/// The picture as CV_8U for a detector: the channels' mean, scaled so that its 99.5th percentile is white (dark
/// pictures become usable), sRGB-encoded. Empty when the picture holds no light or no contrast at all.
cv::Mat detector_copy(const formats::Image& image);

/// Whether all channels hold the same in every pixel: a grey picture.
bool all_channels_alike(const formats::Image& image);

/// The channel that geometry is measured in: green where there is one, else the only or middle channel.
int reference_channel(const formats::Image& image);

}  // namespace lensproof::calibration
