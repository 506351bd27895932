// calibration/lines/scene_line.h — an edge of the scene that is taken to be straight, as it is seen in a picture.
#pragma once
#include <string>
#include <vector>

#include "engine/base/json_archive.h"
#include "engine/base/vec.h"

namespace lensproof::calibration {

/// The points of one edge in order, to a fraction of a pixel; and what a fit made of it.
struct SceneLine {
    std::string image;
    std::vector<Vec2d> points_px;
    double noise_px = 0.0;            // of a point across the edge: its scatter about a smooth curve
    bool used = false;                // false: no lens that straightens most of the others straightens this one
    double rms_px = 0.0;              // of the points across the straight line's image, two unknowns counted
    double bow_px = 0.0;              // root mean square of the part of that which is a bend or an S
    std::vector<double> residual_px;  // of each point, positive to the left of the line's way from first to last
};

/// The distance between the ends.
double chord_px(const SceneLine& line);

/// `image`, `used`, `rms_px`, `bow_px`, `noise_px`, `points_px`, `residual_px`.
void fields(JsonArchive& json, SceneLine& line);

}  // namespace lensproof::calibration
