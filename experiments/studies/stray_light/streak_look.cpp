#include "experiments/studies/stray_light/streak_look.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <vector>

#include "engine/base/angle.h"
#include "engine/base/power_law.h"

namespace lensproof::studies {

namespace {

constexpr int kRings = 8;
constexpr double kInnermost = 0.06;  // of the picture's height: beyond the lamp's own image

double brightness(const formats::Image& image, int x, int y) {
    double sum = 0.0;
    for (int c = 0; c < image.channel_count(); ++c) {
        sum += image.at(x, y, c) / image.channel_count();
    }
    return sum;
}

/// In lens space, mm.
Vec2d middle_of_light(const formats::Image& image, const render::Sensor& sensor) {
    Vec2d middle;
    double light = 0.0;
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            const double here = brightness(image, x, y);
            middle = middle + here * sensor.position(x, y);
            light += here;
        }
    }
    return middle / light;
}

struct Ring {
    double pixels = 0.0;
    double log_radius = 0.0;          // a sum over the pixels
    std::complex<double> harmonic{};  // of the streaks' number
};

}  // namespace

StreakLook streak_look(const formats::Image& diffracted, const formats::Image& direct, const render::Sensor& sensor,
                       const optics::PolygonStop& stop) {
    const Vec2d middle = middle_of_light(direct, sensor);
    const double height = sensor.height * sensor.pixel_pitch_mm;
    // Up to the nearest edge of the frame, beyond which rings have gaps.
    const Vec2d lamp = sensor.pixel(middle);
    const double to_edge =
        std::min({lamp.x + 0.5, sensor.width - 0.5 - lamp.x, lamp.y + 0.5, sensor.height - 0.5 - lamp.y});
    const double outermost = std::max(2.0 * kInnermost, to_edge / sensor.height);
    // Edges that face each other make one streak across both.
    const int streaks = stop.blades % 2 == 0 ? stop.blades : 2 * stop.blades;
    std::array<Ring, kRings> rings;
    for (int y = 0; y < diffracted.height; ++y) {
        for (int x = 0; x < diffracted.width; ++x) {
            const Vec2d off = sensor.position(x, y) - middle;
            const double radius = std::hypot(off.x, off.y) / height;
            const double at = kRings * std::log(radius / kInnermost) / std::log(outermost / kInnermost);
            if (!(at >= 0.0 && at < kRings)) {
                continue;
            }
            Ring& ring = rings[static_cast<std::size_t>(at)];
            const double light = brightness(diffracted, x, y);
            ring.pixels += 1.0;
            ring.log_radius += std::log(radius);
            // Rings are wide: with the cube every radius counts alike, and what the lamp has no part in cancels.
            ring.harmonic += std::polar(light * radius * radius * radius, streaks * std::atan2(off.y, off.x));
        }
    }
    const double normal = (stop.rotation_deg + 180.0 / stop.blades) * kDegree;
    std::vector<Vec2d> fall;
    double sum = 0.0;
    double square = 0.0;
    for (const Ring& ring : rings) {
        const double off = std::arg(ring.harmonic * std::polar(1.0, -streaks * normal)) / streaks / kDegree;
        sum += off;
        square += off * off;
        fall.push_back({std::exp(ring.log_radius / ring.pixels), std::abs(ring.harmonic) / ring.pixels});
    }
    const PowerLaw fall_off = power_law(fall);
    const double mean = sum / kRings;
    return {.offset_deg = mean,
            .offset_error_deg = std::sqrt(std::max(0.0, square / kRings - mean * mean) / (kRings - 1)),
            .slope = fall_off.exponent - 3.0,
            .slope_error = fall_off.standard_error};
}

}  // namespace lensproof::studies
