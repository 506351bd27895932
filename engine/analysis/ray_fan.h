// engine/analysis/ray_fan.h — ray fans: how far a field's rays miss the reference chief ray in the image plane.
#pragma once
#include <optional>
#include <vector>

#include "engine/analysis/beam_outline.h"

namespace lensproof::analysis {

/// Which of the bundle's rays: those in the meridional plane (offsets along y), or those across it (along x).
enum class FanPlane { tangential, sagittal };

struct FanPoint {
    double pupil;   // the offset over that of the fan's farther rim: −1 … 1, 0 the chief ray
    double offset;  // mm across the chief ray, along the fan
    Vec2d error{};  // mm in the sensor's plane, from the reference point
};

/// The ray at `offset` against the point `reference` in the sensor's plane; nothing where it does not get there. Rims
/// are passed: what they cut is not asked.
std::optional<Vec2d> transverse_error(const optics::TraceLens<double>& lens, const optics::FieldBundle& bundle,
                                      Vec2d offset, Vec2d reference);

/// `count` rays (2 or more), evenly spaced from rim to rim along a line through the chief ray. Where that is clipped,
/// the meridional fan is that part of the line that the beam's middle lies on, and there is no sagittal one: empty.
std::vector<FanPoint> ray_fan(const optics::TraceLens<double>& lens, const optics::FieldBundle& bundle,
                              const optics::RegionOutline& outline, FanPlane plane, Vec2d reference, int count);

}  // namespace lensproof::analysis
