// calibration/detection/disc_centroid.h — where the centroid of a projected disc lies.
#pragma once
#include <array>
#include <cmath>
#include <numbers>

#include "engine/base/vec.h"

namespace lensproof::calibration {

/// Centroid of the image of a disc, given any smooth map from the chart to the picture.
///
/// The image of a regular 12-gon stands for the image of the disc. Its radius is chosen so that the polygon has the
/// disc's second moments, ρ² = 3 R² / (2 + cos(2π/12)): to second order in R, which is the perspective eccentricity
/// (Heikkilä 2000, "Geometric camera calibration using circular control points"), the two centroids are the same.
/// `map(x, y, pixel)` returns false where nothing is imaged; so does this function then.
template <class T, class Map>
bool disc_centroid(const Map& map, double x, double y, double diameter, Vec2<T>& centroid) {
    constexpr int corners = 12;
    const double step = 2.0 * std::numbers::pi / corners;
    const double radius = 0.5 * diameter * std::sqrt(3.0 / (2.0 + std::cos(step)));
    Vec2<T> middle;
    if (!map(x, y, middle)) {
        return false;
    }
    std::array<Vec2<T>, corners> polygon;  // relative to the image of the centre, so that nothing cancels
    for (int i = 0; i < corners; ++i) {
        if (!map(x + radius * std::cos(i * step), y + radius * std::sin(i * step), polygon[i])) {
            return false;
        }
        polygon[i].x -= middle.x;
        polygon[i].y -= middle.y;
    }
    T area2(0.0);
    Vec2<T> moment6{T(0.0), T(0.0)};
    for (int i = 0; i < corners; ++i) {
        const Vec2<T>& a = polygon[i];
        const Vec2<T>& b = polygon[(i + 1) % corners];
        const T cross = a.x * b.y - b.x * a.y;
        area2 += cross;
        moment6.x += (a.x + b.x) * cross;
        moment6.y += (a.y + b.y) * cross;
    }
    if (area2 == T(0.0)) {
        return false;
    }
    centroid.x = middle.x + moment6.x / (T(3.0) * area2);
    centroid.y = middle.y + moment6.y / (T(3.0) * area2);
    return true;
}

}  // namespace lensproof::calibration
