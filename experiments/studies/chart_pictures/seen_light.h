// experiments/studies/chart_pictures/seen_light.h — a feature's light in a picture, without what is about it.
#pragma once
#include <functional>
#include <vector>

#include "engine/formats/image/image.h"
#include "engine/render/film/sensor.h"
#include "experiments/studies/chart_pictures/light_moments.h"

namespace lensproof::studies {

/// What of a feature's surroundings a place of the film belongs to.
enum class Zone { feature, border, beyond };

/// The light of a feature: what the picture has there less the plane through its border, of either sign, so that a
/// black feature's light is what it keeps from the white.
struct SeenLight {
    std::vector<FilmLight> light;  // where the feature is; at: mm in lens space
    Vec3d about;                   // the border's light in the feature's middle
    bool is_in_frame = true;       // else the picture ends within the border, and nothing is told
};

/// `middle`: mm in lens space. `reach`: no place farther from it, mm, is of the feature or its border. `zone_of`: of a
/// place, mm from the middle.
SeenLight seen_light(const formats::Image& rgb, const render::Sensor& sensor, Vec2d middle, double reach,
                     const std::function<Zone(Vec2d)>& zone_of);

}  // namespace lensproof::studies
