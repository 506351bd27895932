// Straight things through known cameras, as points and as pictures; for the tests of calibration/lines.
#pragma once
#include <algorithm>
#include <cmath>
#include <optional>
#include <random>
#include <vector>

#include "calibration/lines/scene_line.h"
#include "engine/base/angle.h"
#include "tests/calibration/synthetic.h"

namespace lensproof::calibration::synthetic {

/// Numbers from 0 to 1 that depend on the seed alone.
class Chance {
  public:
    explicit Chance(unsigned seed) : engine_(seed) {}
    double operator()(double low = 0.0, double high = 1.0) {
        return low + (high - low) * static_cast<double>(engine_()) / 4294967296.0;
    }

  private:
    std::mt19937 engine_;
};

struct LineNoise {
    double white_px = 0.1;
    double bow_px = 0.0;  // standard deviation of a line's own bend, at its middle against its ends
};

/// The image of the straight line through two points of the scene, a point about every three pixels inside the frame;
/// none shorter than a tenth of the diagonal.
inline std::optional<SceneLine> seen_line(const CameraModel& camera, int width, int height, const Vec3d& from,
                                          const Vec3d& to, const LineNoise& blur, Noise& noise) {
    constexpr int kSteps = 4000;
    SceneLine line{.image = "synthetic", .points_px = {}, .noise_px = blur.white_px, .residual_px = {}};
    for (int i = 0; i <= kSteps; ++i) {
        const auto pixel = project(camera, from + (static_cast<double>(i) / kSteps) * (to - from));
        if (!pixel || pixel->x < 3 || pixel->y < 3 || pixel->x > width - 4 || pixel->y > height - 4) {
            continue;
        }
        if (line.points_px.empty() ||
            std::hypot(pixel->x - line.points_px.back().x, pixel->y - line.points_px.back().y) >= 3.0) {
            line.points_px.push_back(*pixel);
        }
    }
    if (line.points_px.size() < 15 || chord_px(line) < 0.1 * std::hypot(width, height)) {
        return std::nullopt;
    }
    const Vec2d chord = line.points_px.back() - line.points_px.front();
    const double length = std::hypot(chord.x, chord.y);
    const Vec2d across{chord.y / length, -chord.x / length};
    const double bow = blur.bow_px * noise();
    const auto last = static_cast<double>(line.points_px.size() - 1);
    for (std::size_t i = 0; i < line.points_px.size(); ++i) {
        const double t = 2.0 * static_cast<double>(i) / last - 1.0;
        line.points_px[i] = line.points_px[i] + (bow * (1.0 - t * t) + blur.white_px * noise()) * across;
    }
    return line;
}

/// `count` lines anywhere in front of the camera, a depth of 1 away, within `reach` of the axis.
inline std::vector<SceneLine> random_lines(const CameraModel& camera, int width, int height, int count, double reach,
                                           const LineNoise& blur, unsigned seed) {
    Chance chance(seed);
    Noise noise(seed + 1000003);
    std::vector<SceneLine> lines;
    while (static_cast<int>(lines.size()) < count) {
        const auto anywhere = [&] { return Vec3d{chance(-reach, reach), chance(-reach, reach), 1.0}; };
        const Vec3d from = anywhere();
        const Vec3d to = anywhere();
        if (auto line = seen_line(camera, width, height, from, to, blur, noise)) {
            lines.push_back(std::move(*line));
        }
    }
    return lines;
}

/// What a camera's pixels see of the plane a depth of 1 away, `samples` × `samples` places a pixel.
struct PixelRays {
    int width = 0;
    int height = 0;
    int samples = 0;
    std::vector<Vec2d> places;
};

inline PixelRays pixel_rays(const CameraModel& camera, int width, int height, int samples) {
    PixelRays rays{width, height, samples, {}};
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            for (int k = 0; k < samples * samples; ++k) {
                const int row = k / samples;
                const Vec2d pixel{x - 0.5 + (k % samples + 0.5) / samples, y - 0.5 + (row + 0.5) / samples};
                const Vec3d direction = unproject(camera, pixel).value();
                rays.places.push_back({direction.x / direction.z, direction.y / direction.z});
            }
        }
    }
    return rays;
}

/// A thing on the plane: a rectangle, or a disc as wide as `half.x` says.
struct FlatThing {
    Vec2d centre;
    Vec2d half;
    double turn_rad = 0.0;
    double light = 0.0;
    bool is_disc = false;

    [[nodiscard]] bool holds(const Vec2d& p) const {
        const Vec2d q = p - centre;
        if (is_disc) {
            return q.x * q.x + q.y * q.y < half.x * half.x;
        }
        const double c = std::cos(turn_rad);
        const double s = std::sin(turn_rad);
        return std::abs(c * q.x + s * q.y) < half.x && std::abs(c * q.y - s * q.x) < half.y;
    }
};

/// The things one over the other on grey, each pixel the mean of its places.
inline formats::Image picture_of(const PixelRays& rays, const std::vector<FlatThing>& things, double noise,
                                 unsigned seed) {
    formats::Image image = formats::make_image(rays.width, rays.height, {"G"});
    Noise draw(seed);
    const std::size_t each = static_cast<std::size_t>(rays.samples) * rays.samples;
    for (std::size_t pixel = 0; pixel < image.pixels.size(); ++pixel) {
        double sum = 0.0;
        for (std::size_t k = 0; k < each; ++k) {
            double light = 0.45;
            for (const FlatThing& thing : things) {
                light = thing.holds(rays.places[pixel * each + k]) ? thing.light : light;
            }
            sum += light;
        }
        image.pixels[pixel] = static_cast<float>(sum / static_cast<double>(each) + noise * draw());
    }
    return image;
}

/// Rectangles of many sizes, turned anyhow, bright and dark in turn.
inline std::vector<FlatThing> random_rectangles(int count, double reach_x, double reach_y, unsigned seed) {
    Chance chance(seed);
    std::vector<FlatThing> things;
    things.reserve(static_cast<std::size_t>(count));
    for (int i = 0; i < count; ++i) {
        things.push_back({.centre = {chance(-reach_x, reach_x), chance(-reach_y, reach_y)},
                          .half = {chance(0.3, 0.6) * reach_x, chance(0.15, 0.35) * reach_x},
                          .turn_rad = chance(0.0, kPi),
                          .light = i % 2 == 0 ? chance(0.7, 0.95) : chance(0.05, 0.2)});
    }
    return things;
}

/// 100 (r / (f tan θ) − 1) of a camera, percent.
inline double true_distortion_percent(const CameraModel& camera, double radius_px) {
    return 100.0 * (radius_px / (focal_length_px(camera) * std::tan(*field_angle_rad(camera, radius_px))) - 1.0);
}

}  // namespace lensproof::calibration::synthetic
