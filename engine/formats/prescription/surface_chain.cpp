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

}  // namespace

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
