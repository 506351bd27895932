#include "engine/analysis/field_curves.h"

namespace lensproof::analysis {

std::vector<double> even_fields(double largest, int count) {
    std::vector<double> fields(static_cast<std::size_t>(count));
    for (int i = 0; i < count; ++i) {
        fields[i] = largest * i / (count - 1);
    }
    return fields;
}

std::vector<FieldCurvePoint> field_curves(const ColourOfLens& colour, const ColourOfLens& reference,
                                          optics::Projection projection, std::span<const double> fields,
                                          double object_distance) {
    const double plane_z = distortion_plane(reference.lens, object_distance);
    std::vector<FieldCurvePoint> curve;
    for (const double field : fields) {
        const auto bundle = optics::field_bundle(colour.chief_rays, field, object_distance);
        const auto pencil = bundle ? ray_pencil(colour.lens, *bundle) : std::nullopt;
        if (pencil) {
            curve.push_back({.field_angle = field,
                             .image_height = bundle->chief.image_height,
                             .distortion_percent = distortion_percent(colour.lens, projection, *bundle, plane_z),
                             .foci = astigmatic_foci(*pencil, colour.lens.image_z)});
        }
    }
    return curve;
}

std::vector<LateralColourPoint> lateral_colour(std::span<const ColourOfLens> colours, const ColourOfLens& reference,
                                               std::span<const double> fields, double object_distance) {
    std::vector<LateralColourPoint> curve;
    for (const double field : fields) {
        const auto aimed = optics::field_bundle(reference.chief_rays, field, object_distance);
        if (!aimed) {
            continue;
        }
        LateralColourPoint point{.field_angle = field, .image_height = aimed->chief.image_height, .shift = {}};
        for (const ColourOfLens& colour : colours) {
            if (const auto own = optics::same_object(*aimed, colour.chief_rays)) {
                point.shift.push_back(own->chief.image_height - point.image_height);
            }
        }
        if (point.shift.size() == colours.size()) {
            curve.push_back(std::move(point));
        }
    }
    return curve;
}

std::vector<IlluminationPoint> illumination_curve(const ColourOfLens& colour, const ColourOfLens& reference,
                                                  std::span<const double> fields, double object_distance) {
    const auto light_at = [&](double field) -> std::optional<std::pair<FieldLight, double>> {
        const auto aimed = optics::field_bundle(reference.chief_rays, field, object_distance);
        const auto own = aimed ? optics::same_object(*aimed, colour.chief_rays) : std::nullopt;
        if (!own) {
            return std::nullopt;
        }
        return std::pair(field_light(colour.lens, *own, aimed->chief.image_point), aimed->chief.image_height);
    };
    std::vector<IlluminationPoint> curve;
    const auto axis = light_at(0.0);
    for (const double field : fields) {
        const auto here = axis ? light_at(field) : std::nullopt;
        if (here) {
            curve.push_back(
                {.field_angle = field, .image_height = here->second, .light = light_ratio(here->first, axis->first)});
        }
    }
    return curve;
}

}  // namespace lensproof::analysis
