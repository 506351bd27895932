#include "calibration/detection/line_segments.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "calibration/detection/working_copy.h"

namespace lensproof::calibration {

double length_of(const LineSegment& segment) {
    return length(segment.to - segment.from);
}

Vec2d direction_of(const LineSegment& segment) {
    return (segment.to - segment.from) / length_of(segment);
}

FoundSegments find_segments(const formats::Image& image) {
    cv::Mat copy = detector_copy(image);
    if (copy.empty()) {
        return {};
    }
    constexpr double kLongestSide_px = 2400.0;
    const double shrink = std::min(1.0, kLongestSide_px / std::max(copy.cols, copy.rows));
    if (shrink < 1.0) {
        cv::resize(copy, copy, {}, shrink, shrink, cv::INTER_AREA);
    }
    std::vector<cv::Vec4f> lines;
    cv::createLineSegmentDetector(cv::LSD_REFINE_STD)->detect(copy, lines);
    FoundSegments found{.segments = {}, .scale = static_cast<double>(image.width) / copy.cols};
    const double scale_y = static_cast<double>(image.height) / copy.rows;
    const auto whole = [&](double x, double y) {
        return Vec2d{(x + 0.5) * found.scale - 0.5, (y + 0.5) * scale_y - 0.5};
    };
    for (const cv::Vec4f& line : lines) {
        const LineSegment segment{whole(line[0], line[1]), whole(line[2], line[3])};
        if (length_of(segment) > 0.0) {
            found.segments.push_back(segment);
        }
    }
    return found;
}

}  // namespace lensproof::calibration
