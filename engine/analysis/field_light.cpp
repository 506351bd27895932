#include "engine/analysis/field_light.h"

#include "engine/optics/illumination.h"

namespace lensproof::analysis {

FieldLight field_light(const optics::TraceLens<double>& lens, const optics::FieldBundle& bundle, Vec2d image_point) {
    FieldLight light{.beam = beam_outline(lens, bundle), .image = {}};
    if (light.beam.is_empty()) {
        return light;
    }
    // Backwards along the ray in the beam's middle: towards light, whatever became of the chief ray.
    const optics::TracedRay<double> middle = optics::trace(lens, bundle.ray(light.beam.centre));
    const Vec2d towards{-middle.ray.direction.x, -middle.ray.direction.y};
    light.image = optics::image_outline(lens, image_point, towards);
    return light;
}

FieldLightRatio light_ratio(const FieldLight& field, const FieldLight& axis) {
    const auto ratio = [](double a, double b) { return b > 0.0 ? a / b : 0.0; };
    return {.vignetting = ratio(field.beam.area, axis.beam.area),
            .relative_illumination = ratio(field.image.area, axis.image.area)};
}

}  // namespace lensproof::analysis
