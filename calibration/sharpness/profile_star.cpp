#include "calibration/sharpness/profile_star.h"

#include "calibration/sharpness/profile_edge.h"

namespace lensproof::calibration {

void fields(JsonArchive& json, StarSegment& segment, const std::optional<double>& pixel_pitch_um) {
    json.field("frequency_deg", segment.frequency_deg)
        .field("side_deg", segment.side_deg)
        .field("contrast", segment.contrast)
        .field("contrast_standard_error", segment.contrast_standard_error);
    mtf_fields(json, "mtf50", segment.mtf50, pixel_pitch_um);
    mtf_fields(json, "mtf10", segment.mtf10, pixel_pitch_um);
    json.group("curve", [&](JsonArchive& curve) {
        curve.field("cycles_per_px", segment.cycles_per_px)
            .numbers("mtf", segment.mtf, segment.cycles_per_px.size())
            .numbers("standard_error", segment.mtf_standard_error, segment.cycles_per_px.size());
    });
}

void fields(JsonArchive& json, ProfileStar& star, const std::optional<double>& pixel_pitch_um) {
    EllipseOutline& rim = star.star.outline;
    json.field("image", star.image)
        .field("centre_px", star.star.centre_px)
        .group("outline",
               [&](JsonArchive& outline) {
                   Vec2d half_axes{rim.long_half_axis_px, rim.short_half_axis_px};
                   outline.field("centre_px", rim.centre_px)
                       .field("half_axes_px", half_axes)
                       .field("angle_deg", rim.angle_deg);
                   rim.long_half_axis_px = half_axes.x;
                   rim.short_half_axis_px = half_axes.y;
               })
        .field("segments", star.star.segments, pixel_pitch_um);
}

}  // namespace lensproof::calibration
