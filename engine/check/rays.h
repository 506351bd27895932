// engine/check/rays.h — real rays that the checks ask about, and where they fail.
#pragma once
#include <string>
#include <vector>

#include "engine/check/checked_lens.h"

namespace lensproof {

/// What became of a ray on its way to the image plane.
struct RayFate {
    RayStatus status = RayStatus::ok;
    int surface = 0;                 // from 0: where it failed, or was cut first
    bool is_backwards = false;       // it met `surface` before the one in front of it: no physical order
    double largest_incidence = 0.0;  // rad
    int steepest_surface = 0;
    Ray<double> ray;  // behind the last surface that it reached

    [[nodiscard]] bool passes() const { return status == RayStatus::ok && !is_backwards; }
};

RayFate follow(const TraceLens<double>& lens, const Ray<double>& ray, Rims rims = Rims::clip);

/// A failed ray's fate in words: "it misses surface 3".
std::string words(const RayFate& fate);

/// The lens with rims so wide that none cuts; with `keep_stop`, the stop still does.
TraceLens<double> without_rims(const CheckedLens& checked, bool keep_stop);

/// The rays from the axial object point, by their height in the plane of the first vertex.
struct AxialBeam {
    double semi_diameter = 0.0;  // mm: the largest height up to which every ray passes
    RayFate limit;               // of the ray just above
    double exit_sine = 0.0;      // of the outermost ray's angle with the axis behind the lens
};

AxialBeam axial_beam(const CheckedLens& checked);

/// The beam that the stop alone would leave.
AxialBeam stop_limited_beam(const CheckedLens& checked);

/// The rms distance (mm) from the axis of the axial beam's rays in the plane where that is smallest.
double axial_blur(const CheckedLens& checked, double beam_semi_diameter);

}  // namespace lensproof
