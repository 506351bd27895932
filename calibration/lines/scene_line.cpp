#include "calibration/lines/scene_line.h"

#include <cmath>

namespace lensproof::calibration {

double chord_px(const SceneLine& line) {
    if (line.points_px.empty()) {
        return 0.0;
    }
    const Vec2d span = line.points_px.back() - line.points_px.front();
    return std::hypot(span.x, span.y);
}

void fields(JsonArchive& json, SceneLine& line) {
    json.field("image", line.image)
        .field("used", line.used)
        .field("rms_px", line.rms_px)
        .field("bow_px", line.bow_px)
        .field("noise_px", line.noise_px)
        .field("points_px", line.points_px)
        .numbers("residual_px", line.residual_px, line.points_px.size());
}

}  // namespace lensproof::calibration
