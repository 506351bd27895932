// experiments/studies/chart_pictures/light_moments.h — how light is spread on the film: its centroid, widths,
// asymmetry.
#pragma once
#include <cmath>
#include <vector>

#include "engine/base/vec.h"

namespace lensproof::studies {

/// Light at a point of the film: mm along the radius from the axis, mm across it.
struct FilmLight {
    Vec2d at;
    Vec3d rgb;
};

/// Central moments, by light.
struct LightMoments {
    double light = 0.0;
    Vec2d centroid;          // mm
    Vec2d rms;               // mm
    double asymmetry = 0.0;  // the third moment of x over the second, mm
};

/// Of one of R, G and B.
inline LightMoments light_moments(const std::vector<FilmLight>& light, double Vec3d::*colour) {
    LightMoments moments;
    for (const FilmLight& one : light) {
        moments.light += one.rgb.*colour;
        moments.centroid = moments.centroid + one.rgb.*colour * one.at;
    }
    moments.centroid = moments.centroid / moments.light;
    Vec2d square;
    double cube = 0.0;
    for (const FilmLight& one : light) {
        const Vec2d off = one.at - moments.centroid;
        square = square + one.rgb.*colour * Vec2d{off.x * off.x, off.y * off.y};
        cube += one.rgb.*colour * off.x * off.x * off.x;
    }
    // What noise leaves of a width of nothing may be below it.
    const auto root = [&](double sum) { return std::sqrt(std::max(0.0, sum / moments.light)); };
    moments.rms = {root(square.x), root(square.y)};
    moments.asymmetry = cube / square.x;
    return moments;
}

}  // namespace lensproof::studies
