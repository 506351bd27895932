// experiments/studies/stray_light/streak_look.h — where a picture's glare streaks stand, and how its halo falls off.
#pragma once
#include "engine/formats/image/image.h"
#include "engine/optics/prescription.h"
#include "engine/render/film/sensor.h"

namespace lensproof::studies {

/// Measured in rings about a lamp's image, evenly spaced in the logarithm of their radius; the standard errors are
/// those of the rings' mean and of the line through them.
struct StreakLook {
    double offset_deg = 0.0;  // of the streaks from the normals of the stop's edges, from +x towards +y of lens space
    double offset_error_deg = 0.0;
    double slope = 0.0;  // of the logarithm of the streaks' light over the radius's; far from every edge −3
    double slope_error = 0.0;
};

/// `diffracted`, `direct`: the picture's light of these passes, of one lamp. Its image is the middle of the latter.
StreakLook streak_look(const formats::Image& diffracted, const formats::Image& direct, const render::Sensor& sensor,
                       const optics::PolygonStop& stop);

}  // namespace lensproof::studies
