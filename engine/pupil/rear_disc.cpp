#include "engine/pupil/rear_disc.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "engine/base/infinity.h"
#include "engine/optics/surface_axes.h"
#include "engine/pupil/surface_cap.h"

namespace lensproof::pupil {

namespace {

constexpr int kRings = 64;
constexpr int kAzimuths = 64;
// Between two azimuths a tilted circle bulges out of its chord by (π/64)² / 2 = 0.12 %.
constexpr double kBulge = 1.0013;

/// The rear surface inside its rim, seen from the axis: the distance from it, and z.
struct CapPoint {
    double radius;
    double z;
};

/// The points of a polar grid on the surface, ring by ring from its vertex to its rim.
std::vector<CapPoint> rear_cap(const optics::TraceLens<double>& lens) {
    const optics::TraceSurface<double>& rear = lens.surfaces.back();
    const auto [shape, rim] = surface_cap(lens, rear);
    std::vector<CapPoint> cap;
    for (int ring = 0; ring <= kRings; ++ring) {
        for (int i = 0; i < kAzimuths; ++i) {
            const double radius = rim * ring / kRings;
            const double azimuth = 2.0 * std::numbers::pi * i / kAzimuths;
            Vec3d at{radius * std::cos(azimuth), radius * std::sin(azimuth), 0.0};
            const double height = optics::sag(shape, at.x, at.y);
            at.z = std::isfinite(height) ? height : 0.0;
            at = optics::from_own_axes(lens, rear, at);
            cap.push_back({rear.special >= 0 ? kBulge * std::hypot(at.x, at.y) : radius, at.z});
        }
    }
    return cap;
}

}  // namespace

RearDisc rear_disc(const optics::TraceLens<double>& lens, double sensor_radius_mm) {
    const std::vector<CapPoint> cap = rear_cap(lens);
    RearDisc disc;
    const double heading = std::copysign(1.0, lens.surfaces.back().index_after);
    disc.plane_z = -heading * kInfinity;
    for (const CapPoint& point : cap) {
        disc.plane_z = heading * std::max(heading * disc.plane_z, heading * point.z);
    }
    if (lens.surfaces.back().special >= 0) {
        // Between the grid's points a tilted or aspheric surface may rise a little higher.
        double largest_step = 0.0;
        for (std::size_t i = kAzimuths; i < cap.size(); ++i) {
            largest_step = std::max(largest_step, std::abs(cap[i].z - cap[i - kAzimuths].z));
        }
        disc.plane_z += heading * 0.5 * largest_step;
    }
    const auto sensor_fraction = [&](const CapPoint& point) {
        return (disc.plane_z - point.z) / (lens.image_z - point.z);
    };
    for (int ring = 0; ring < kRings; ++ring) {
        for (int i = 0; i < kAzimuths; ++i) {
            const int next = (i + 1) % kAzimuths;
            double innermost = kInfinity;
            double outermost = 0.0;
            double largest_fraction = 0.0;
            for (const int corner : {ring * kAzimuths + i, ring * kAzimuths + next, (ring + 1) * kAzimuths + i,
                                     (ring + 1) * kAzimuths + next}) {
                innermost = std::min(innermost, cap[corner].radius / kBulge);
                outermost = std::max(outermost, cap[corner].radius);
                largest_fraction = std::max(largest_fraction, sensor_fraction(cap[corner]));
            }
            disc.radius =
                std::max(disc.radius, outermost + largest_fraction * std::max(0.0, sensor_radius_mm - innermost));
        }
    }
    return disc;
}

}  // namespace lensproof::pupil
