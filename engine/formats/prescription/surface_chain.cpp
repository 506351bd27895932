#include "engine/formats/prescription/surface_chain.h"

#include <algorithm>
#include <cmath>

namespace lensproof::formats {

namespace {

constexpr double kRounding = 1e-12;

optics::Misalignment misalignment_of(const optics::Frame& frame) {
    optics::Misalignment misalignment{.decentre_mm = {frame.origin.x, frame.origin.y},
                                      .tilt_deg = optics::tilt_angles(frame)};
    const auto drop_rounding = [](double& value) { value = std::abs(value) < kRounding ? 0.0 : value; };
    std::ranges::for_each(misalignment.decentre_mm, drop_rounding);
    std::ranges::for_each(misalignment.tilt_deg, drop_rounding);
    return misalignment;
}

/// A vector mirrored in the plane through the origin with this unit normal.
Vec3d mirrored(const Vec3d& v, const Vec3d& normal) {
    return v - (2.0 * dot(v, normal)) * normal;
}

/// What a frame's coordinates become: `by` holds where the origin and the axes of lens space went.
optics::Frame moved(const optics::Frame& frame, const optics::Frame& by) {
    optics::Frame result{.origin = by.origin + by.rotate(frame.origin)};
    std::ranges::transform(frame.axes, result.axes.begin(), [&](const Vec3d& axis) { return by.rotate(axis); });
    return result;
}

bool is_along_axis(const Vec3d& direction) {
    return std::hypot(direction.x, direction.y) < kRounding;
}

/// Turning about the axis changes nothing of a surface of revolution on it.
void forget_turn(ChainLink& link, const optics::PrescribedSurface* row) {
    if (is_along_axis(link.frame.axes[2]) && link.frame.axes[2].z > 0.0 && (row == nullptr || !row->radius_x_mm)) {
        link.frame.axes = optics::Frame{}.axes;
    }
}

}  // namespace

std::vector<int> unfold(std::vector<optics::PrescribedSurface>& rows, std::vector<ChainLink>& links) {
    std::vector<int> folds;
    optics::Frame unfolded;  // where lens space's own axes are taken
    bool is_turned = false;  // they are left-handed, and light runs against the frames' z
    for (std::size_t i = 0; i < links.size(); ++i) {
        ChainLink& link = links[i];
        optics::PrescribedSurface* row = i < rows.size() ? &rows[i] : nullptr;
        link.frame = moved(link.frame, unfolded);
        const bool is_fold = row != nullptr && row->is_mirror && row->is_flat() && !row->is_asphere() && !row->phase &&
                             !is_along_axis(link.frame.axes[2]);
        if (is_turned) {
            link.frame.axes[2] = -1.0 * link.frame.axes[2];
            link.thickness_mm = -link.thickness_mm;
            if (row != nullptr) {
                *row = row->turned();
            }
        }
        if (is_fold) {
            const Vec3d normal = link.frame.axes[2];
            const Vec3d at = link.frame.origin;
            unfolded.origin = at + mirrored(unfolded.origin - at, normal);
            std::ranges::transform(unfolded.axes, unfolded.axes.begin(),
                                   [&](const Vec3d& axis) { return mirrored(axis, normal); });
            is_turned = !is_turned;
            link.frame.axes = optics::Frame{}.axes;
            link.straight = false;
            row->is_mirror = false;
            row->rim_mm.reset();
            if (!row->is_stop) {
                row->semi_diameter_mm.reset();
            }
            folds.push_back(static_cast<int>(i));
        } else if (!folds.empty()) {
            forget_turn(link, row);
        }
    }
    return folds;
}

bool is_upright(const optics::Frame& frame) {
    const std::array<double, 3> tilts = optics::tilt_angles(frame);
    return std::abs(tilts[0]) < kRounding && std::abs(tilts[1]) < kRounding;
}

void place_rows(std::vector<optics::PrescribedSurface>& rows, const std::vector<ChainLink>& links) {
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const ChainLink& link = links[i];
        rows[i].misalignment = misalignment_of(link.frame);
        rows[i].thickness_mm = link.straight && is_upright(link.frame)
                                   ? link.thickness_mm
                                   : links[i + 1].frame.origin.z - link.frame.origin.z;
    }
}

}  // namespace lensproof::formats
