// Pictures of a chart, blurred and noisy, and how far from the truth its points are found; for the tests of detection.
#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "calibration/detection/detect.h"
#include "calibration/detection/refine.h"
#include "engine/base/angle.h"
#include "tests/calibration/synthetic.h"

namespace lensproof::calibration::synthetic {

inline constexpr int kSamples = 6;  // 36 a pixel

struct Taken {
    formats::Image image;
    std::vector<Vec2d> truth_px;
};

struct Shot {
    double tilt_deg = 0.0;
    double roll_deg = 4.0;
    double blur_px = 0.0;  // Gaussian, beside the pixel's own box
    double noise = 0.0;    // of white
    unsigned seed = 1;
    double distance_mm = 640.0;
    Vec2d aside_mm;
};

// One direction of a Gaussian blur; the frame's pixels go on without end.
inline void blur_along(formats::Image& image, const std::vector<double>& kernel, int dx, int dy) {
    const formats::Image source = image;
    const int reach = static_cast<int>(kernel.size()) - 1;
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            double sum = 0.0;
            for (int k = -reach; k <= reach; ++k) {
                sum += kernel[std::abs(k)] * source.at(std::clamp(x + k * dx, 0, image.width - 1),
                                                       std::clamp(y + k * dy, 0, image.height - 1), 0);
            }
            image.at(x, y, 0) = static_cast<float>(sum);
        }
    }
}

inline void blur(formats::Image& image, double sigma_px) {
    std::vector<double> kernel;
    double sum = 0.0;
    for (int k = 0; k <= std::ceil(4.0 * sigma_px); ++k) {
        kernel.push_back(std::exp(-0.5 * k * k / (sigma_px * sigma_px)));
        sum += (k == 0 ? 1.0 : 2.0) * kernel.back();
    }
    for (double& weight : kernel) {
        weight /= sum;
    }
    blur_along(image, kernel, 1, 0);
    blur_along(image, kernel, 0, 1);
}

inline Taken take(const scene::Chart& chart, const CameraModel& camera, const Shot& shot) {
    const double tilt = shot.tilt_deg * kDegree;
    const Pose pose{{0.7 * tilt, -0.6 * tilt, shot.roll_deg * kDegree},
                    {shot.aside_mm.x, shot.aside_mm.y, shot.distance_mm}};
    Taken taken{.image = formats::make_image(640, 480, {"Y"}), .truth_px = {}};
    for (const Vec2d& point : scene::feature_points(chart)) {
        taken.truth_px.push_back(predict(camera, pose, point, disc_diameter_mm(chart)).value_or(Vec2d{-1e3, -1e3}));
    }
    paint(taken.image, 0, camera, pose, chart, kSamples);
    if (shot.blur_px > 0.0) {
        blur(taken.image, shot.blur_px);
    }
    add_noise(taken.image, shot.noise, shot.seed);
    return taken;
}

struct Errors {
    int seen = 0;
    int count = 0;
    Vec2d bias_px;
    double rms_px = 0.0;  // of one coordinate
    double worst_px = 0.0;
};

inline Errors errors(const scene::Chart& chart, const Taken& taken) {
    Errors e;
    const Detection detection = detect(taken.image, chart);
    if (!detection.found()) {
        ADD_FAILURE() << detection.reason;
        return e;
    }
    e.seen = count_found(detection.points);
    const ChartPoints points = refine(taken.image, 0, detection.points, chart);
    for (std::size_t i = 0; i < points.found.size(); ++i) {
        if (points.found[i]) {
            const Vec2d d{points.image_px[i].x - taken.truth_px[i].x, points.image_px[i].y - taken.truth_px[i].y};
            e.bias_px = {e.bias_px.x + d.x, e.bias_px.y + d.y};
            e.rms_px += d.x * d.x + d.y * d.y;
            e.worst_px = std::max(e.worst_px, std::hypot(d.x, d.y));
            ++e.count;
        }
    }
    e.bias_px = {e.bias_px.x / e.count, e.bias_px.y / e.count};
    e.rms_px = std::sqrt(0.5 * e.rms_px / e.count);
    return e;
}

}  // namespace lensproof::calibration::synthetic
