#include "calibration/sharpness/profile_star.h"

#include "calibration/sharpness/profile_edge.h"
#include "engine/base/json.h"

namespace lensproof::calibration {
namespace {
Json segment_json(const StarSegment& segment, std::optional<double> pixel_pitch_um) {
    Json json = {{"frequency_deg", segment.frequency_deg},
                 {"side_deg", segment.side_deg},
                 {"contrast", segment.contrast},
                 {"contrast_standard_error", segment.contrast_standard_error}};
    add_mtf_frequency(json, "mtf50", segment.mtf50, pixel_pitch_um);
    add_mtf_frequency(json, "mtf10", segment.mtf10, pixel_pitch_um);
    json["curve"] = {
        {"cycles_per_px", segment.cycles_per_px}, {"mtf", segment.mtf}, {"standard_error", segment.mtf_standard_error}};
    return json;
}

StarSegment parse_segment(const JsonNode& node) {
    StarSegment segment{.frequency_deg = node.at("frequency_deg").number(),
                        .side_deg = node.at("side_deg").number(),
                        .contrast = node.at("contrast").number(),
                        .contrast_standard_error = node.at("contrast_standard_error").number()};
    segment.mtf50 = parse_mtf_frequency(node, "mtf50");
    segment.mtf10 = parse_mtf_frequency(node, "mtf10");
    const JsonNode curve = node.at("curve");
    segment.cycles_per_px = curve.at("cycles_per_px").numbers();
    segment.mtf = curve.at("mtf").numbers(segment.cycles_per_px.size());
    segment.mtf_standard_error = curve.at("standard_error").numbers(segment.cycles_per_px.size());
    return segment;
}

}  // namespace

Json to_json(const ProfileStar& star, std::optional<double> pixel_pitch_um) {
    const EllipseOutline& rim = star.star.outline;
    Json json = {{"image", star.image},
                 {"centre_px", {star.star.centre_px.x, star.star.centre_px.y}},
                 {"outline",
                  {{"centre_px", {rim.centre_px.x, rim.centre_px.y}},
                   {"half_axes_px", {rim.long_half_axis_px, rim.short_half_axis_px}},
                   {"angle_deg", rim.angle_deg}}},
                 {"segments", Json::list()}};
    for (const StarSegment& segment : star.star.segments) {
        json["segments"].push_back(segment_json(segment, pixel_pitch_um));
    }
    return json;
}

ProfileStar parse_star(const JsonNode& node) {
    ProfileStar result{.image = node.at("image").text(), .star = {}};
    result.star.centre_px = node.at("centre_px").pair();
    const JsonNode rim = node.at("outline");
    const Vec2d axes = rim.at("half_axes_px").pair();
    result.star.outline = {.centre_px = rim.at("centre_px").pair(),
                           .long_half_axis_px = axes.x,
                           .short_half_axis_px = axes.y,
                           .angle_deg = rim.at("angle_deg").number()};
    for (const JsonNode& segment : node.at("segments").elements()) {
        result.star.segments.push_back(parse_segment(segment));
    }
    return result;
}

}  // namespace lensproof::calibration
