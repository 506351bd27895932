// calibration/self_test/simulated_chart.h — pictures of a chart through a camera that is known, to try a measurement
// on.
#pragma once
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "calibration/geometry/board_shape.h"
#include "calibration/geometry/camera_model.h"
#include "calibration/geometry/planar_pose.h"
#include "engine/formats/image/image.h"
#include "engine/scene/chart/chart.h"

namespace lensproof::calibration {

/// What one channel does to the light. Functions are of the image height ρ: the distance from the principal point over
/// the picture's half-diagonal.
struct SimulatedChannel {
    std::string name;
    /// How much farther from the principal point than the camera model says, px.
    std::function<double(double)> radial_shift_px = [](double) { return 0.0; };
    /// Light relative to the axis.
    std::function<double(double)> vignetting = [](double) { return 1.0; };
};

/// A camera whose every property is stated, and how far the chart before it is from flat and evenly lit.
struct SimulatedCamera {
    CameraModel model;
    int width_px = 0;
    int height_px = 0;
    std::vector<SimulatedChannel> channels;
    double white = 0.6;    // what a perfect white on the axis gives; full scale is 1
    double blur_px = 0.5;  // standard deviation of the lens's blur, a Gaussian, before the pixels' own box
    /// Noise has the variance `read_noise`² + `shot_noise`² · value, in units of full scale.
    double read_noise = 0.0;
    double shot_noise = 0.0;
    bool is_grey = false;             // every channel shows what the first does, noise included
    std::optional<int> jpeg_quality;  // 1 to 100, 8-bit sRGB with halved colour resolution; none: floats as they are
    int threads = 0;                  // 0: one a core; they change nothing but the time
    std::optional<BoardShape> board = std::nullopt;  // none: the chart is flat
    /// Of ln(light) over the chart, per mm; its origin has the light that `white` says. Flat fields do not know it.
    Vec2d light_gradient_per_mm = {};
};

/// What the camera shows of `chart` at `pose`. Directions that the model does not image, and those behind the chart's
/// plane, are black.
///
/// Every pixel is the mean of 64 places, of which no two share a column or a row, over the exact edges of the chart,
/// and moved together by a number that differs from pixel to pixel; so a straight edge of n pixels lies within some
/// 0.003 / √n px of where it should; the map to the chart adds less than 1e-3 px (chart_map.h). The same `seed` gives
/// the same bytes.
formats::Image simulate_chart(const SimulatedCamera& camera, const Pose& pose, const scene::Chart& chart,
                              std::uint32_t seed);

/// An even white through the same camera.
formats::Image simulate_flat_field(const SimulatedCamera& camera, std::uint32_t seed);

}  // namespace lensproof::calibration
